// One self-contained script and stylesheet per widget: Jupyter loads each as a single text, in which relative imports
// cannot resolve. A page runs it once, by run_once.ts. Exported pages have separate scripts and stylesheets. Arguments:
// the folder of the widgets, and the folder to build into; both default to those of robowidgets.
import { createHash } from "node:crypto";
import { mkdirSync, readdirSync, writeFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { build, context } from "esbuild";

const watch = process.argv.includes("--watch");
const [from = ".", to = "../static"] = process.argv.slice(2).filter((argument) => !argument.startsWith("--"));
const options = {
  entryPoints: readdirSync(from).flatMap((name) =>
    /(_widget|^export_\w+|^run_once|^later)\.(ts|css)$/.test(name) ? join(from, name) : [],
  ),
  outdir: to,
  // Widgets of other packages import the shared parts by this name.
  alias: { robowidgets: import.meta.dirname },
  bundle: true,
  target: "es2022",
  logLevel: "info",
};

// Scripts of widgets, run_once.ts and later.ts are modules, which run once per page. What they make stays under a key, where an
// exported page finds it, too.
function toModule(name, script) {
  if (name.startsWith("export_")) return script;
  const key = `robowidgets ${createHash("sha256").update(script).digest("hex").slice(0, 16)}`;
  // In parentheses it is compiled at once: else a browser reads it twice, to find its end, and to run it.
  return `const run=(()=>{${script}return widget.default});export default globalThis[Symbol.for("${key}")]??=run();\n`;
}

if (watch) {
  await (await context({ ...options, format: "esm" })).watch();
} else {
  const { outputFiles } = await build({ ...options, format: "iife", globalName: "widget", minify: true, write: false });
  for (const { path, text } of outputFiles) {
    mkdirSync(dirname(path), { recursive: true });
    writeFileSync(path, path.endsWith(".js") ? toModule(basename(path), text) : text);
  }
}
