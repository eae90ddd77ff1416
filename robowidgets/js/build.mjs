// One self-contained script and stylesheet per widget: Jupyter loads each as a single text, in which relative imports
// cannot resolve. Arguments: the folder of the widgets, and the one to build into; without them, those of robowidgets.
import { readdirSync } from "node:fs";
import { join } from "node:path";
import { context } from "esbuild";

const watch = process.argv.includes("--watch");
const [from = ".", to = "../static"] = process.argv.slice(2).filter((argument) => !argument.startsWith("--"));
const build = await context({
  entryPoints: readdirSync(from).flatMap((name) => (/_widget\.(ts|css)$/.test(name) ? join(from, name) : [])),
  outdir: to,
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
