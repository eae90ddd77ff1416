import type { MapAbout } from "../path/traits.ts";
import { make } from "../shared/dom.ts";
import { hasTable, toCsv } from "./csv.ts";
import { Feed, Segments } from "./feed.ts";
import { PageModel } from "./model.ts";
import { findParts, readPart } from "./parts.ts";
import { ScanogramMaker } from "./scanogram.ts";
import { build, FOREVER, type Script, type Shown } from "./views.ts";

/** What Python says of the page; robowidgets/export/models.py. */
export interface PageFacts {
  models: { id: string; widget: string; state: Record<string, unknown> }[];
  /** Model, trait and number of bytes of each binary trait, which follow one after the other. */
  buffers: [string, string, number][];
  shown: Shown;
  /** Of the player; empty without one. */
  player: string;
  /** Of the scanogram that is drawn here from the scans of a track. */
  scanogram: { model: string; track: number } | null;
  /** Time at which the first segment begins. */
  begin: number;
  /** By the names of widgets that are not built into the page, under which their scripts leave what they make. */
  keys: Record<string, string>;
  /** The beginning of the names of files that are saved. */
  name: string;
}

/** Milliseconds for which a page waits for a script of a widget. */
const PATIENCE_MS = 10_000;

/** Milliseconds after which a browser has saved a file. */
const SAVED_MS = 60_000;

type Widgets = Record<string, () => Script>;

/** Builds the page from its parts. */
export async function start(widgets: Widgets): Promise<void> {
  const [place, element] = [document.querySelector("main"), findParts("page")[0]];
  if (!place || !element) throw new Error("this page is not whole");
  const { facts, bytes } = await readPart<PageFacts>(element.textContent);
  const css = [...document.querySelectorAll("style")].map((style) => style.textContent).join("\n");
  const models = toModels(facts, bytes, css);
  await haveRun(Object.values(facts.keys));
  const scripts = new Map<string, Script>();
  for (const { id, widget } of facts.models) scripts.set(id, scriptOf(widget, facts, widgets));
  // All models are there before the first is initialised: a player moves the others.
  for (const [id, model] of models) scripts.get(id)?.initialize?.({ model, signal: FOREVER });
  place.append(build(facts.shown, models, scripts));
  document.querySelector(".rw-page-text")?.remove();
  const player = models.get(facts.player);
  if (!player) return;
  const segments = new Segments(findParts("segment"), player.get("_segment"), facts.begin);
  offerData(facts, player, segments);
  const scanogram = facts.scanogram && models.get(facts.scanogram.model);
  const maker = scanogram ? new ScanogramMaker(scanogram, segments, facts.scanogram?.track ?? 0) : null;
  await new Feed(player, segments).run();
  await maker?.run();
}

/** @param css what the widgets put into a picture that is saved */
export function toModels(
  facts: Pick<PageFacts, "models" | "buffers">,
  bytes: Uint8Array<ArrayBuffer>,
  css: string,
): Map<string, PageModel> {
  const states = new Map(facts.models.map(({ id, state }) => [id, state]));
  let at = bytes.byteOffset;
  for (const [id, trait, length] of facts.buffers) {
    const state = states.get(id);
    if (state) state[trait] = new DataView(bytes.buffer, at, length);
    at += length;
  }
  const models = new Map<string, PageModel>();
  for (const [id, state] of states) models.set(id, new PageModel({ ...state, _style: css }, models));
  return models;
}

/** Waits for scripts, which run in any order and leave what they make under these keys. */
async function haveRun(keys: string[]): Promise<void> {
  const until = performance.now() + PATIENCE_MS;
  while (!keys.every((key) => Symbol.for(key) in globalThis) && performance.now() < until) {
    await new Promise((resume) => setTimeout(resume));
  }
}

function scriptOf(widget: string, { keys }: PageFacts, widgets: Widgets): Script {
  const made = widgets[widget] ?? (globalThis as Record<symbol, unknown>)[Symbol.for(keys[widget] ?? "")];
  if (typeof made === "function") return made();
  if (made) return made as Script;
  throw new Error(`the script of ${widget} is not in this page`);
}

/** Buttons that save the samples of a topic, exactly as they were recorded. */
function offerData({ models, name }: PageFacts, player: PageModel, segments: Segments): void {
  const place = document.querySelector(".rw-page-data");
  const targets: string[] = player.get("_targets");
  for (const [track, id] of targets.entries()) {
    const found = models.find((model) => model.id === id);
    if (!place || !found || !hasTable(found.widget)) continue;
    // Odometry has a file for its speeds and one for its poses.
    const topic = `${found.state.title}${found.widget === "path_widget" ? " path" : ""}`;
    const button = make("button", "rw-page-save", `${topic} as CSV`);
    button.type = "button";
    button.addEventListener("click", async () => {
      const frames = [];
      for (const number of segments.numbers) frames.push(...segments.framesOf(await segments.read(number), track));
      save(
        `${name}-${topic.split(/[/ ]/).filter(Boolean).join("-")}.csv`,
        toCsv(found.widget, frames, (found.state._map as MapAbout | undefined)?.layers),
      );
    });
    place.append(button);
  }
}

function save(name: string, text: string): void {
  const link = make("a", "");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  link.download = name;
  link.click();
  // Safari reads the text after the click.
  setTimeout(() => URL.revokeObjectURL(link.href), SAVED_MS);
}
