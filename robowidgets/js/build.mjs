// One self-contained script and stylesheet per widget: Jupyter loads each as a single text, in which relative imports
// cannot resolve. Exported pages have scripts and stylesheets of their own. Arguments: the folder of the widgets, and the one to build into; without them, those of robowidgets.
import { createHash } from "node:crypto";
import { mkdirSync, readdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { build, context } from "esbuild";

const watch = process.argv.includes("--watch");
const [from = ".", to = "../static"] = process.argv.slice(2).filter((argument) => !argument.startsWith("--"));
const options = {
  entryPoints: readdirSync(from).flatMap((name) =>
    /(_widget|^export_\w+)\.(ts|css)$/.test(name) ? join(from, name) : [],
  ),
  outdir: to,
  bundle: true,
  target: "es2022",
  logLevel: "info",
};

// Jupyter imports the script anew for each widget, and a page keeps every module that it has imported. So the first one
// runs the code, and the others take what it made: a page then has the code of a widget once, not once per instance.
// JupyterLab keeps the models of closed widgets, too. So each model gets the first one's script and style in place of its
// own, which are equal: nothing is sent. The last one is set again, because Backbone keeps what was before the last set.
function share(script) {
  const key = `robowidgets ${createHash("sha256").update(script).digest("hex").slice(0, 16)}`;
  return `const run=()=>{${script}
const made=widget.default,first={};
return()=>{
  const own=typeof made==="function"?made():made;
  return{...own,initialize(given){
    for(const name of["_esm","_css","_css"]){
      const text=given.model.get(name);
      if(text&&text===(first[name]??=text))given.model.set(name,first[name]);
    }
    return own.initialize?.(given);
  }}
}};export default globalThis[Symbol.for("${key}")]??=run();
`;
}

if (watch) {
  await (await context({ ...options, format: "esm" })).watch();
} else {
  const { outputFiles } = await build({ ...options, format: "iife", globalName: "widget", minify: true, write: false });
  for (const { path, text } of outputFiles) {
    mkdirSync(dirname(path), { recursive: true });
    writeFileSync(path, path.endsWith("_widget.js") ? share(text) : text);
  }
}
