// One self-contained module per widget: Jupyter loads each as a single text, in which relative imports cannot resolve.
import { readdirSync } from "node:fs";
import { context } from "esbuild";

const watch = process.argv.includes("--watch");
const options = { bundle: true, outdir: "../static", charset: "utf8", minify: !watch, logLevel: "info" };
const builds = await Promise.all([
  context({
    ...options,
    entryPoints: readdirSync(".").filter((name) => name.endsWith("_widget.ts")),
    format: "esm",
    target: "es2022",
  }),
  context({ ...options, entryPoints: ["robowidgets.css"] }),
]);
if (watch) {
  await Promise.all(builds.map((build) => build.watch()));
} else {
  await Promise.all(builds.map((build) => build.rebuild()));
  await Promise.all(builds.map((build) => build.dispose()));
}
