import type { MapAbout } from "../path/traits.ts";
import { copyText } from "../shared/copy.ts";
import { make } from "../shared/dom.ts";
import { linkFor, offerLinks } from "../shared/link.ts";
import { hasTable, toCsv } from "./csv.ts";
import { Feed, Segments } from "./feed.ts";
import { FOREVER, type Script, showWidget } from "./host.ts";
import { PageModel } from "./model.ts";
import { momentOf, type Named, parseMoment, showMoment, toHash } from "./moment.ts";
import { explain, findParts, readPart } from "./parts.ts";
import { ScanogramMaker } from "./scanogram.ts";

/** Facts about the page, from Python; robowidgets/export/models.py. */
export interface PageFacts {
  models: { id: string; widget: string; state: Record<string, unknown> }[];
  /** Model, trait and number of bytes of each binary trait, which follow one after the other. */
  buffers: [string, string, number][];
  /** The model that is shown. */
  root: string;
  /** Model of the player, or "" without one. */
  player: string;
  /** Model and track of the scanogram that is drawn here from scans. */
  scanogram: { model: string; track: number } | null;
  /** Time at which the first segment begins. */
  begin: number;
  /**
   * By the names of widgets that are not built into the page, the keys under which their scripts leave their exports.
   */
  keys: Record<string, string>;
  /** The contact sheet, and for each of its moments the number of its first part and of the parts that follow. */
  sheet?: string;
  moments?: Record<string, [first: number, count: number]>;
  /** The beginning of the names of files that are saved. */
  name: string;
}

/** Milliseconds for which a page waits for a script of a widget. */
const PATIENCE_MS = 10_000;

/** Milliseconds for which a button says that it has copied. */
const COPIED_MS = 2000;

/** Milliseconds after which a browser has saved a file. */
const SAVED_MS = 60_000;

type Widgets = Record<string, () => Script>;

/** Builds the page from its parts. */
export async function start(widgets: Widgets): Promise<void> {
  const [place, element] = [document.querySelector("main"), findParts("page")[0]];
  if (!place || !element) throw new Error("this page is not whole");
  const shown = { named: [] as Named };
  offerLinks(() => `${location.href.split("#")[0]}${toHash(momentOf(shown.named))}`);
  const onModels = (named: Named) => {
    shown.named = named;
    showLinked(named);
  };
  const { facts, models } = await show(element, place, widgets, findParts("segment"), FOREVER, onModels);
  window.addEventListener("hashchange", () => showLinked(shown.named));
  document.querySelector(".rw-page-text")?.remove();
  offerMoments(facts, models, place, widgets);
}

/** Shows the moment in the address. */
function showLinked(named: Named): void {
  const moment = parseMoment(location.hash);
  if (moment) showMoment(named, moment);
}

/**
 * Builds the widgets of a part, and gives a player among them its segments.
 * @param onModels is called with the models before they are shown
 */
async function show(
  element: HTMLElement,
  place: HTMLElement,
  widgets: Widgets,
  parts: HTMLElement[],
  signal: AbortSignal,
  onModels: (named: Named) => void = () => {},
): Promise<{ facts: PageFacts; models: Map<string, PageModel> }> {
  const { facts, bytes } = await readPart<PageFacts>(element.textContent);
  const css = [...document.querySelectorAll("style")].map((style) => style.textContent).join("\n");
  const models = toModels(facts, bytes, css);
  await haveRun(Object.values(facts.keys));
  const scripts = new Map<string, Script>();
  for (const { id, widget } of facts.models) scripts.set(id, scriptOf(widget, facts, widgets));
  if (signal.aborted) return { facts, models };
  const player = models.get(facts.player);
  // Base64 has four characters for three bytes.
  const packed = parts.reduce((sum, { textContent }) => sum + (textContent?.length ?? 0), 0);
  player?.set("_unpacking", Math.round((packed * 3) / 4));
  onModels(toNamed(facts, models));
  await showWidget(facts.root, models, scripts, place, signal);
  if (player) play(facts, models, player, parts).catch((error) => explain(`This page cannot be played: ${error}`));
  return { facts, models };
}

async function play(
  facts: PageFacts,
  models: Map<string, PageModel>,
  player: PageModel,
  parts: HTMLElement[],
): Promise<void> {
  const segments = new Segments(parts, player.get("_segment"), facts.begin);
  offerData(facts, player, segments);
  const scanogram = facts.scanogram && models.get(facts.scanogram.model);
  const maker = scanogram ? new ScanogramMaker(scanogram, segments, facts.scanogram?.track ?? 0) : null;
  await new Feed(player, segments).run();
  await maker?.run();
}

/**
 * Opens the moments of a contact sheet below it, as Python does in a notebook: each has a part, followed by its
 * segments.
 */
function offerMoments(facts: PageFacts, models: Map<string, PageModel>, place: HTMLElement, widgets: Widgets): void {
  const { moments = {}, sheet = "" } = facts;
  const model = models.get(sheet);
  if (!model) return;
  const parts = findParts("segment");
  let open = new AbortController();
  model.on("sent", async (content) => {
    const number = (content as { open?: number }).open;
    const [first = -1, count = 0] = moments[String(number)] ?? [];
    const element = parts[first];
    if (!element) return;
    open.abort();
    open = new AbortController();
    const { signal } = open;
    const own = make("div", "rw-page-moment");
    document.querySelector(".rw-page-moment")?.remove();
    place.append(own);
    document.querySelector(".rw-page-data")?.replaceChildren();
    await show(element, own, widgets, parts.slice(first + 1, first + 1 + count), signal);
    if (signal.aborted) return;
    model.set("_opened", number);
    model.fire("msg:custom", { opened: number }, []);
  });
}

/** The models of a page with the names of their scripts. */
export function toNamed(facts: Pick<PageFacts, "models">, models: Map<string, PageModel>): Named {
  return facts.models.flatMap(({ id, widget }) => {
    const model = models.get(id);
    return model ? [{ widget, model }] : [];
  });
}

/** @param css the stylesheet that the widgets put into a saved picture */
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

/** Waits for scripts, which run in any order and leave their exports under these keys. */
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

/** Buttons that save the samples of a topic as they were recorded, but with the robot's angles if a scanner is turned. */
function offerData({ models, name }: PageFacts, player: PageModel, segments: Segments): void {
  const place = document.querySelector(".rw-page-data");
  if (place) place.append(makeLinkButton());
  const targets: string[] = player.get("_targets");
  for (const [track, id] of targets.entries()) {
    const found = models.find((model) => model.id === id);
    if (!place || !found || !hasTable(found.widget)) continue;
    for (const [topic, role] of topicsOf(found.widget, found.state)) {
      const button = make("button", "rw-page-save", `${topic} as CSV`);
      button.type = "button";
      button.addEventListener("click", async () => {
        const frames = await segments.samplesOf(track, role);
        const layers = (found.state._map as MapAbout | undefined)?.layers;
        const file = `${name}-${topic.split(/[/ ]/).filter(Boolean).join("-")}.csv`;
        save(file, toCsv(found.widget, frames, layers, role));
      });
      place.append(button);
    }
  }
}

/** A button that copies a link to the moment on show, which the address shows then. */
function makeLinkButton(): HTMLElement {
  const button = make("button", "rw-page-save", "Copy link");
  button.type = "button";
  button.title = "Copy a link to this moment";
  button.addEventListener("click", async () => {
    const link = linkFor(button);
    const isCopied = await copyText(link);
    history.replaceState(null, "", link);
    button.textContent = isCopied ? "Copied" : "The link is in the address bar";
    setTimeout(() => {
      button.textContent = "Copy link";
    }, COPIED_MS);
  });
  return button;
}

/** The topics of a widget that are saved as files, with the role of each if there are several. */
function topicsOf(widget: string, { title, command_title }: Record<string, unknown>): [topic: string, role?: string][] {
  const [measured, commanded] = [`${title}`, `${command_title ?? ""}`];
  if (widget === "speed_widget" && commanded) {
    return [
      [measured, "measured"],
      [commanded, "commanded"],
    ];
  }
  // Odometry has a file for its speeds and one for its poses.
  return [[widget === "path_widget" ? `${measured} path` : measured]];
}

function save(name: string, text: string): void {
  const link = make("a", "");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  link.download = name;
  link.click();
  // Safari reads the text after the click.
  setTimeout(() => URL.revokeObjectURL(link.href), SAVED_MS);
}
