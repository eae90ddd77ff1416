// One self-contained script and stylesheet per widget: Jupyter loads each as a single text, in which relative imports
// cannot resolve.
import { readdirSync } from "node:fs";
import { context } from "esbuild";

const watch = process.argv.includes("--watch");
const build = await context({
  entryPoints: readdirSync(".").filter((name) => /_widget\.(ts|css)$/.test(name)),
  outdir: "../static",
  bundle: true,
  format: "esm",
  target: "es2022",
  charset: "utf8",
  minify: !watch,
  logLevel: "info",
});
if (watch) {
  await build.watch();
} else {
  await build.rebuild();
  await build.dispose();
}
