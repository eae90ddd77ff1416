// One self-contained module per widget: Jupyter loads each as a single text, in which relative imports cannot resolve.
import { readFileSync, writeFileSync } from "node:fs";
import { context } from "esbuild";
import { minify } from "terser";
import * as short from "./short.mjs";

// Properties of our own that the bundles call by a letter. A test keeps out what the page, a model or anywidget knows.
const ownNames = new RegExp(`^(${JSON.parse(readFileSync("own_names.json", "utf8")).join("|")})$`);
const shortened = Object.fromEntries(
  Object.keys(short).map((name) => [`${name.slice(1) in Math ? "Math" : "Number"}.${name.slice(1)}`, name]),
);

// Terser sees what is used once, and puts it where it is used: of a bundle 2 % that travel with every widget.
const tighten = {
  name: "tighten",
  setup: (build) =>
    build.onEnd(async ({ outputFiles = [] }) => {
      for (const { path, text } of outputFiles) {
        writeFileSync(path, (await minify(text, { module: true, compress: { passes: 2 } })).code);
      }
    }),
};

const watch = process.argv.includes("--watch");
const builds = await Promise.all([
  context({
    entryPoints: [
      "drive_widget.ts",
      "laser_widget.ts",
      "player_widget.ts",
      "scanogram_widget.ts",
      "speed_widget.ts",
      "stop_widget.ts",
      "touch_widget.ts",
    ],
    outdir: "../static",
    bundle: true,
    format: "esm",
    target: "es2022",
    charset: "utf8",
    minify: !watch,
    ...(watch ? {} : { mangleProps: ownNames, write: false, plugins: [tighten] }),
    define: shortened,
    inject: ["./short.mjs"],
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
