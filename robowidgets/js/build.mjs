// One self-contained module per widget: Jupyter loads each as a single text, in which relative imports cannot resolve.
import { context } from "esbuild";

const watch = process.argv.includes("--watch");
const builds = await Promise.all([
  context({
    entryPoints: ["laser_widget.ts", "speed_widget.ts", "touch_widget.ts"],
    outdir: "../static",
    bundle: true,
    format: "esm",
    target: "es2022",
    minify: !watch,
    logLevel: "info",
  }),
  context({ entryPoints: ["robowidgets.css"], bundle: true, outdir: "../static", minify: !watch, logLevel: "info" }),
]);
if (watch) {
  await Promise.all(builds.map((build) => build.watch()));
} else {
  await Promise.all(builds.map((build) => build.rebuild()));
  await Promise.all(builds.map((build) => build.dispose()));
}
