import type { Models, NotebookContext } from "./later/saved_pictures.ts";
import { STATE, UNSEEN, WIDGET } from "./later/widget_types.ts";
import type { LATER } from "./later.ts";

/**
 * The module that Jupyter imports for each widget, and keeps as long as the widget: it runs the widget's own script
 * once per page.
 */

interface Given {
  model: {
    get(name: string): string;
    /** Returns the model itself, if it is a model of ipywidgets. */
    set(name: string, value: string): unknown;
    on(event: string, callback: (content: { later?: string }) => void): void;
    off(event: string, callback: (content: { later?: string }) => void): void;
    send(content: unknown): void;
    widget_manager?: Partial<Models> & { get_state?: unknown; context?: NotebookContext & { model?: Notebook } };
  };
  el: HTMLElement;
  signal: AbortSignal;
}

/** The outputs of a notebook as JupyterLab displays them. */
interface Notebook {
  cells: Iterable<{ outputs?: Outputs }> & { changed: { connect(slot: () => void): void } };
  dirty: boolean;
  /** Returns the content of the file. */
  toJSON(): NotebookFile;
}

type Data = Record<string, unknown>;

interface Output {
  type: string;
  data?: Data;
}

interface NotebookFile {
  cells: { outputs?: { data?: Data }[] }[];
  metadata: { widgets?: { [STATE]?: { state?: Data } } };
}

interface Outputs {
  length: number;
  get(index: number): Output & { toJSON(): object };
  set(index: number, output: object): void;
}

interface Widget {
  initialize?(given: Given): unknown;
  render(given: Given): unknown;
}

type Message = { content: { data: { method: string } } };
type Handler = (message: Message) => Promise<unknown>;

/** anywidget's model in Jupyter. */
interface JupyterModel {
  comm?: { on_msg(handler: Handler): void; send(data: { method: string }, callbacks: object): void };
  _handle_comm_msg: Handler;
}

/** A script that has run. */
type Ran = Promise<{ default: Widget | (() => Widget) }>;

const scripts = new Map<string, Ran>();
const copies = new Map<string, string>();
/** The stylesheets that the document's head and shadow roots have. */
const styled = new WeakMap<Node, Set<string>>();

/** The page's copy of a text. V8 frees the memory of another copy that it has looked up. */
function copyOf(text: string): string {
  if (!copies.has(text)) copies.set(text, text);
  return copies.get(text) as string;
}

function run(script: string): Ran {
  const url = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
  const ran: Ran = import(url).finally(() => URL.revokeObjectURL(url));
  scripts.set(script, ran);
  return ran;
}

function style(place: Node, text: string): void {
  const has = styled.get(place) ?? new Set();
  if (has.has(text)) return;
  styled.set(place, has.add(text));
  const element = document.createElement("style");
  element.textContent = text;
  place.appendChild(element);
}

/**
 * Receives messages of the kernel even if the page was too busy for anywidget, which gives a widget two seconds from
 * its making to the end
 * of `initialize`, and rejects each message after that. The state as a whole replaces the rejected messages.
 *
 * Needed for anywidget 0.11: https://github.com/manzt/anywidget/blob/main/packages/anywidget/src/runtime.ts
 */
async function hearAlsoIfLate(model: JupyterModel): Promise<void> {
  try {
    await model._handle_comm_msg({ content: { data: { method: "none" } } });
  } catch {
    const { _handle_comm_msg: handle } = Object.getPrototypeOf(Object.getPrototypeOf(model)) as JupyterModel;
    model.comm?.on_msg((message) => handle.call(model, message));
    model.comm?.send({ method: "request_state" }, {});
  }
}

/** Milliseconds after the first view: it is painted before. */
const LATER_MS = 1000;
/** The functions by which the views ask Python for the script of later.ts. */
const asks = new Set<() => void>();
let asker: (() => void) | undefined;
/** Undefined once the script has come. */
let load: ((script: string) => void) | undefined;
const later = new Promise<typeof LATER>((resolve) => {
  load = (script) => {
    load = undefined;
    asks.clear();
    const ran = run(script) as Promise<unknown> as Promise<{ default: typeof LATER }>;
    resolve(
      ran.then(({ default: parts }) => {
        parts.explainWords(document);
        return parts;
      }),
    );
  };
});
const pictures = new WeakMap<NotebookContext, { soon(): void }>();
const models = new WeakMap<Element, Given["model"]>();

/** Has one of the views ask for the script; another one if that view ends before the answer. */
function askForLater(): void {
  for (asker of asks) {
    try {
      asker();
      return;
    } catch {
      // The kernel of this view has ended; a view of another notebook may have one.
      asks.delete(asker);
    }
  }
  asker = undefined;
}

function loadLater({ model, signal }: Given): void {
  if (!load) return;
  const ask = () => model.send({ later: true });
  const onAnswer = ({ later: script }: { later?: string }) => {
    if (script) load?.(script);
  };
  asks.add(ask);
  model.on("msg:custom", onAnswer);
  signal.addEventListener("abort", () => {
    model.off("msg:custom", onAnswer);
    if (asks.delete(ask) && asker === ask) askForLater();
  });
  if (asks.size === 1) setTimeout(() => asker ?? askForLater(), LATER_MS);
}

/** Keeps the pictures of a notebook in it, in JupyterLab and Notebook 7; does nothing in other hosts. */
function keepPicture({ model, el, signal }: Given): void {
  const manager = model.widget_manager;
  const context = manager?.context;
  // Solara has such a context without these.
  if (!context?.sessionContext?.iopubMessage || !context.saveState) return;
  models.set(el, model);
  void later.then(({ keepPictures }) => {
    const styleOf = (element: Element) => models.get(element)?.get("_style");
    if (!pictures.has(context)) pictures.set(context, keepPictures(context, manager as Models, styleOf));
  });
  const onFreeze = () => pictures.get(context)?.soon();
  model.on("change:paused change:playing", onFreeze);
  signal.addEventListener("abort", () => model.off("change:paused change:playing", onFreeze));
}

const watched = new WeakSet<Notebook>();

/** Shows the widgets whose pictures a saved notebook has, if the kernel still has them. */
function showWidgets(notebook: Notebook, manager: Partial<Models>): void {
  for (const { outputs } of notebook.cells) {
    for (let i = 0; i < (outputs?.length ?? 0); i++) {
      const output = outputs?.get(i);
      // Of a stream, reading the data would join all of its text.
      if (!output || output.type === "stream" || !output.data) continue;
      const reference = output.data[UNSEEN] as { model_id: string } | undefined;
      if (!reference || WIDGET in output.data || !manager.has_model?.(reference.model_id)) continue;
      const { dirty } = notebook;
      outputs?.set(i, { ...output.toJSON(), data: { ...output.data, [WIDGET]: reference } });
      notebook.dirty = dirty;
    }
  }
}

/**
 * Returns the content of a file in which outputs with a picture refer to a widget only if the file has its state.
 * JupyterLab would show an unknown widget as an error, and not its picture.
 */
function toFile(content: NotebookFile): NotebookFile {
  const saved = content.metadata.widgets?.[STATE]?.state ?? {};
  const toOutput = <O extends { data?: Data }>(output: O): O => {
    const { [WIDGET]: _widget, ...readable } = output.data ?? {};
    const reference = readable[UNSEEN] as { model_id: string } | undefined;
    return !reference || reference.model_id in saved ? output : { ...output, data: readable };
  };
  const cells = content.cells.map((cell) => (cell.outputs ? { ...cell, outputs: cell.outputs.map(toOutput) } : cell));
  return { ...content, cells };
}

/** Saves pictures for unknown widgets, and shows the known ones when the page is loaded or the notebook read again. */
function keepReadable({ widget_manager: manager }: Given["model"]): void {
  const notebook = manager?.context?.model;
  if (!notebook?.cells?.changed) return;
  showWidgets(notebook, manager as Models);
  if (watched.has(notebook)) return;
  watched.add(notebook);
  const toJSON = notebook.toJSON.bind(notebook);
  notebook.toJSON = () => toFile(toJSON());
  notebook.cells.changed.connect(() => queueMicrotask(() => showWidgets(notebook, manager as Models)));
}

export default () => {
  let widget: Widget;
  let closed: AbortSignal;
  return {
    async initialize(given: Given) {
      const { model } = given;
      closed = given.signal;
      const script = copyOf(model.get("_script"));
      const sheet = copyOf(model.get("_style"));
      if (model.widget_manager?.get_state) {
        // A model of ipywidgets releases its own texts, and sends nothing, because these are equal; another host would
        // send them. It keeps the values before the last set.
        void hearAlsoIfLate(model.set("_script", script) as JupyterModel);
        for (let i = 0; i < 2; i++) model.set("_style", sheet);
        keepReadable(model);
      }
      const { default: make } = await (scripts.get(script) ?? run(script));
      widget = typeof make === "function" ? make() : make;
      return widget.initialize?.(given);
    },
    render(given: Given) {
      const { el, model } = given;
      const dress = () => {
        const root = el.getRootNode();
        style(root instanceof ShadowRoot ? root : document.head, copyOf(model.get("_style")));
      };
      dress();
      if (!el.isConnected) {
        // It may be inserted into a shadow root, whose changes the document does not observe.
        const observer = new ResizeObserver(() => {
          if (!el.isConnected) return;
          observer.disconnect();
          dress();
        });
        observer.observe(el);
      }
      loadLater(given);
      keepPicture(given);
      // A view within another widget does not end by itself if its model is closed.
      return widget.render({ ...given, signal: AbortSignal.any([given.signal, closed]) });
    },
  };
};
