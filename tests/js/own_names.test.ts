import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const JS = fileURLToPath(new URL("../../robowidgets/js/", import.meta.url));
const OWN_NAMES: string[] = JSON.parse(readFileSync(`${JS}own_names.json`, "utf8"));
const PYTHON = fileURLToPath(new URL("../../robowidgets/", import.meta.url));

/** All that a pattern finds in the files of a folder, without comments. */
function found(folder: string, files: RegExp, pattern: RegExp): Set<string> {
  const texts = readdirSync(folder, { recursive: true, encoding: "utf8" })
    .filter((name) => files.test(name))
    .map((name) =>
      readFileSync(`${folder}${name}`, "utf8")
        .replace(/\/\*[\s\S]*?\*\//g, "")
        .replace(/\/\/.*/g, ""),
    );
  assert.ok(texts.length > 0, `no such files in ${folder}`);
  return new Set(texts.flatMap((text) => [...text.matchAll(pattern)].map((match) => match.slice(1).join(""))));
}

const OURS = /^(?!node_modules).*\.ts$/;
const MEMBER = /^\s+(?:readonly |get |set )?"?(\w+)"?\??\s*[:(<]/gm;
const FOREIGN = {
  "the page or the language has it": found(`${JS}node_modules/@typescript/`, /\/lib\.(dom|es)[\w.]*\.d\.ts$/, MEMBER),
  "anywidget has it": found(`${JS}node_modules/@anywidget/types/`, /\.d\.ts$/, /(\w+)/g),
  "a model may have it": found(PYTHON, /^\w+\.py$/, /^ {4}(\w+)(?:: [^=]+)? = |["'](\w+)["']:/gm),
  "it may be missing, as what Python sends in dictionaries may": found(JS, OURS, /^\s+(\w+)\?:/gm),
  "it is quoted": found(JS, OURS, /["'`](\w+)["'`]/g),
  "it is an attribute of data": found(JS, OURS, /dataset\.(\w+)/g),
};

test("the build shortens no name that anybody else knows", () => {
  for (const [why, names] of Object.entries(FOREIGN)) {
    assert.deepEqual(
      OWN_NAMES.filter((name) => names.has(name)),
      [],
      why,
    );
  }
});

test("the build shortens no name that is not used", () => {
  const used = found(JS, OURS, /(\w+)/g);
  assert.deepEqual(
    OWN_NAMES.filter((name) => !used.has(name)),
    [],
  );
});
