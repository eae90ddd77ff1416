import { make } from "../shared/dom.ts";
import { paint } from "../shared/painting.ts";
import { toIndexed, toPng } from "./indexed_png.ts";
import { UNSEEN, WIDGET } from "./widget_types.ts";

/**
 * The pictures of widgets in the outputs of a notebook, where readers without a kernel find them.
 *
 * An update of the output by the kernel would make JupyterLab render the widget again. So the page writes the pictures,
 * past the views, into the document that is saved.
 */

const SMALLEST = 0.25;
/** Types and scales of a picture, the best first. The first that is small enough is kept. */
const TRIES = [
  ["image/png", 2],
  ["image/png", 1],
  ["image/jpeg", 1],
  ["image/jpeg", 0.5],
  ["image/jpeg", SMALLEST],
] as const;
const MAX_BYTES = 60_000;
/** Pixels of a picture that is not tried at twice its size. */
const LARGE = 500_000;
const MAX_WORDS = 2000;
/** Milliseconds without another cell that ends, or another freeze. */
const QUIET_MS = 500;
/** Parts of the page that are not for readers. */
const LEFT_OUT = ".rw-stop-bar, .rw-drive, .rw-topics-cell, .rw-topics";
const WORDLESS = "button, style, svg, select, input, .rw-controls, .rw-steps, .rw-unseen, .rw-name-twin";

interface Signal<A> {
  connect(slot: (sender: unknown, argument: A) => void): void;
}

interface Message {
  header: { msg_type: string };
  parent_header: { msg_type?: string };
  content: { execution_state?: string };
}

type Data = Record<string, unknown>;

/** An output in the shared document of JupyterLab 4.2 or later. */
interface Output {
  get(name: "data" | "metadata"): Data | undefined;
  set(name: "data" | "metadata", value: Data): void;
}

interface SharedCell {
  ymodel: { get(name: "outputs"): { toArray(): Output[] } | undefined };
  transact(change: () => void, undoable: boolean, origin: string): void;
}

/** A notebook that JupyterLab has open. */
export interface NotebookContext {
  readonly isDisposed: boolean;
  readonly model: { cells: Iterable<{ sharedModel: SharedCell }> };
  readonly sessionContext: { iopubMessage: Signal<Message> };
  readonly saveState: Signal<string>;
  save(): Promise<void>;
}

/** The models of ipywidgets in a notebook. */
export interface Models {
  has_model(id: string): boolean;
  get_model(id: string): Promise<{ views?: Record<string, Promise<{ el: HTMLElement }>> }>;
}

/** The stylesheet of the widget that has an element as its own; undefined for other elements. */
export type StyleOf = (element: Element) => string | undefined;

interface Picture {
  type: string;
  base64: string;
  width: number;
  height: number;
}

export class SavedPictures {
  readonly #context: NotebookContext;
  readonly #models: Models;
  readonly #styleOf: StyleOf;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #atWork: Promise<boolean> = Promise.resolve(false);
  #atSave: Promise<boolean> | null = null;
  #savesAgain = false;

  constructor(context: NotebookContext, models: Models, styleOf: StyleOf) {
    this.#context = context;
    this.#models = models;
    this.#styleOf = styleOf;
    context.sessionContext.iopubMessage.connect((_, { header, parent_header, content }) => {
      if (header.msg_type !== "status" || parent_header.msg_type !== "execute_request") return;
      if (content.execution_state === "idle") this.soon();
    });
    context.saveState.connect((_, state) => this.#onSave(state));
    this.soon();
  }

  /** Writes the pictures, once nothing else calls this for a moment. */
  soon(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#write(), QUIET_MS);
  }

  /** Saves the notebook once more if its pictures have changed since. */
  async #onSave(state: string): Promise<void> {
    if (state === "started" && !this.#savesAgain) this.#atSave = this.#write();
    if (!state.startsWith("completed") || !this.#atSave) return;
    const written = this.#atSave;
    this.#atSave = null;
    if (!(await written) || this.#context.isDisposed) return;
    this.#savesAgain = true;
    await this.#context.save().finally(() => {
      this.#savesAgain = false;
    });
  }

  /** Writes the pictures that have changed, one call after the other; returns true if there were any. */
  #write(): Promise<boolean> {
    clearTimeout(this.#timer);
    const write = () => this.#writeAll();
    this.#atWork = this.#atWork.then(write, write); // an error of one call is on the console and ends no later one
    return this.#atWork;
  }

  async #writeAll(): Promise<boolean> {
    let isChanged = false;
    if (this.#context.isDisposed) return isChanged;
    for (const { sharedModel } of this.#context.model.cells) {
      for (const output of sharedModel.ymodel.get("outputs")?.toArray() ?? []) {
        const id = output.get?.("data")?.[WIDGET] as { model_id?: string } | undefined;
        const view = id?.model_id && (await this.#viewOf(id.model_id));
        if (view) isChanged = (await this.#writeOne(sharedModel, output, view)) || isChanged;
      }
    }
    return isChanged;
  }

  async #viewOf(id: string): Promise<HTMLElement | undefined> {
    if (!this.#models.has_model(id)) return undefined;
    const { views = {} } = await this.#models.get_model(id);
    const all = await Promise.all(Object.values(views));
    return all.map(({ el }) => el).find((el) => el.isConnected && el.offsetWidth > 0);
  }

  async #writeOne(cell: SharedCell, output: Output, view: HTMLElement): Promise<boolean> {
    const cards = cardsIn(view);
    if (!cards.length) return false;
    const words = cards.map((card) => wordsOf(card).replace(/\s+/g, " ").trim().slice(0, MAX_WORDS)).join("\n");
    const picture = await pictureOf(cards, (card) => this.#styleWithin(card));
    if (!picture) return false;
    const { type, base64, width, height } = picture;
    const data = output.get("data") ?? {};
    if (data[type] === base64 && data["text/plain"] === words && UNSEEN in data) return false;
    const { "image/png": _png, "image/jpeg": _jpeg, ...rest } = data;
    cell.transact(
      () => {
        output.set("data", { ...rest, [UNSEEN]: rest[WIDGET], "text/plain": words, [type]: base64 });
        output.set("metadata", { ...output.get("metadata"), [type]: { width, height } });
      },
      false,
      // A change of the outputs as a list would have JupyterLab render them again. This one only goes into the file.
      "silent-change",
    );
    return true;
  }

  #styleWithin(card: HTMLElement): string {
    const sheets = new Set<string>();
    for (const inner of [card, ...card.querySelectorAll(".rw-card")]) {
      for (let at: Element | null = inner; at; at = at.parentElement) {
        const sheet = this.#styleOf(at);
        if (sheet !== undefined) sheets.add(sheet);
      }
    }
    return [...sheets].join("\n");
  }
}

/** The cards of a view that are on show and in no other card, without those that only drive or choose. */
function cardsIn(view: HTMLElement): HTMLElement[] {
  return [...view.querySelectorAll<HTMLElement>(".rw-card")].filter(
    (card) =>
      card.offsetWidth > 0 &&
      card.offsetHeight > 0 &&
      !card.closest(LEFT_OUT) &&
      !card.parentElement?.closest(".rw-card"),
  );
}

/** The text of an element as its reader sees it. */
function wordsOf(node: Node): string {
  if (node instanceof Text) return node.data;
  if (!(node instanceof HTMLElement) || node.matches(WORDLESS)) return "";
  const { display, visibility } = getComputedStyle(node);
  if (display === "none" || visibility === "hidden") return "";
  if (node.classList.contains("rw-name")) return ` ${node.textContent} `;
  return ` ${[...node.childNodes].map(wordsOf).join("")} `;
}

/** The boxes of cards. A bar that stays in view while the page scrolls has the box that it has in an unscrolled page. */
function boxesOf(cards: HTMLElement[]): DOMRect[] {
  const stuck = cards
    .flatMap((card) => card.closest<HTMLElement>(".rw-item") ?? [])
    .filter((item) => getComputedStyle(item).position === "sticky");
  for (const item of stuck) item.style.position = "relative";
  const boxes = cards.map((card) => card.getBoundingClientRect());
  for (const item of stuck) item.style.position = "";
  return boxes;
}

/**
 * Cards in one picture, at their places, in at most `MAX_BYTES`, or twice as many for several cards; null if all of
 * them were hidden or removed meanwhile.
 */
async function pictureOf(cards: HTMLElement[], styleOf: (card: HTMLElement) => string): Promise<Picture | null> {
  const boxes = boxesOf(cards);
  const left = Math.min(...boxes.map((box) => box.left));
  const top = Math.min(...boxes.map((box) => box.top));
  const width = Math.round(Math.max(...boxes.map((box) => box.right)) - left);
  const height = Math.round(Math.max(...boxes.map((box) => box.bottom)) - top);
  if (!width || !height) return null;
  const maxBytes = cards.length > 1 ? 2 * MAX_BYTES : MAX_BYTES;
  const best = width * height > LARGE ? 1 : 2;
  const paper = canvasOf(width * best, height * best);
  const pen = paper.getContext("2d");
  if (pen) pen.fillStyle = getComputedStyle(cards[0] as HTMLElement).backgroundColor;
  pen?.fillRect(0, 0, paper.width, paper.height);
  for (const [i, card] of cards.entries()) {
    const painted = await paint(card, styleOf(card), best);
    const box = boxes[i] as DOMRect;
    // The user may have hidden or removed it meanwhile.
    if (painted.width && painted.height) pen?.drawImage(painted, (box.left - left) * best, (box.top - top) * best);
    await untilIdle();
  }
  for (const [type, scale] of TRIES) {
    if (scale > best) continue;
    const bytes = await encode(paper, type, scale / best);
    if (bytes.length <= maxBytes || scale === SMALLEST) return { type, base64: toBase64(bytes), width, height };
  }
  throw new Error("unreachable");
}

function canvasOf(width: number, height: number): HTMLCanvasElement {
  return Object.assign(make("canvas", ""), { width: Math.round(width), height: Math.round(height) });
}

async function encode(paper: HTMLCanvasElement, type: string, scale: number): Promise<Uint8Array> {
  let small = paper;
  if (scale !== 1) {
    small = canvasOf(paper.width * scale, paper.height * scale);
    const pen = small.getContext("2d");
    if (pen) pen.imageSmoothingQuality = "high";
    pen?.drawImage(paper, 0, 0, small.width, small.height);
  }
  if (type === "image/png") {
    const pixels = small.getContext("2d")?.getImageData(0, 0, small.width, small.height).data;
    return toPng(await toIndexed(pixels as Uint8ClampedArray, untilIdle), small.width);
  }
  const blob = await new Promise<Blob>((resolve, reject) => {
    small.toBlob((encoded) => (encoded ? resolve(encoded) : reject(new Error("no picture"))), type, 0.8);
  });
  return new Uint8Array(await blob.arrayBuffer());
}

function toBase64(bytes: Uint8Array): string {
  return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
}

/** Resolves once the page has drawn what waits. Safari has no idle callbacks. */
function untilIdle(): Promise<void> {
  return new Promise((resolve) => {
    if (typeof requestIdleCallback === "function") requestIdleCallback(() => resolve(), { timeout: 1000 });
    else setTimeout(resolve, 50);
  });
}

/** Keeps the pictures of a notebook in it. */
export function keepPictures(context: NotebookContext, models: Models, styleOf: StyleOf): SavedPictures {
  return new SavedPictures(context, models, styleOf);
}
