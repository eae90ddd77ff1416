import { make, makeButton, set, setLabel, setText } from "../shared/dom.ts";
import { onAbort } from "../shared/events.ts";
import { lacksKernel, type Model, newName } from "../shared/model.ts";
import type { StopTraits } from "./traits.ts";

/** Pixels round the view in its pane, above and below. */
const PADDING = 16;
/** Least height of a view: in a lower pane it scrolls. */
const LOWEST = 420;
const CANNOT = "This page has no place beside the notebook. robot.show() shows the view here.";
const SINGLE = "JupyterLab shows one document at a time: switch off Simple, at the bottom left, and press Beside.";

/** Parts of JupyterLab's widget manager that other hosts lack: the document, which can show a widget next to itself. */
interface Host {
  get_model(id: string): Promise<unknown>;
  create_view?(model: unknown): Promise<View>;
  context?: { addSibling?(widget: Pane, options: { ref?: string | undefined; mode: string; type: string }): unknown };
}

interface View {
  luminoWidget?: Pane;
  once(event: "remove", callback: () => void): void;
}

/** A widget of Lumino. */
interface Pane {
  id: string;
  readonly node: HTMLElement;
  readonly isAttached: boolean;
  readonly isDisposed: boolean;
  readonly title: { label: string; closable: boolean };
  addClass(name: string): void;
  readonly disposed: { connect(callback: () => void): unknown };
  dispose(): void;
}

interface WidgetClass {
  new (): Pane;
  attach(widget: Pane, host: HTMLElement): void;
}

interface PaneNode extends HTMLElement {
  rwPane?: Pane;
}

/**
 * Puts the view of a robot next to the notebook, into a pane like that of JupyterLab's "Create New View for Cell
 * Output", by a button, or as soon as the bar is on the page. Other hosts have no such place. The pane closes with the
 * view, and with the output of its cell, which the next run replaces.
 */
export class Beside {
  readonly button: HTMLButtonElement;
  readonly words = make("div", "rw-stop-beside");
  readonly #model: Model<StopTraits>;
  readonly #root: HTMLElement;
  readonly #signal: AbortSignal;
  #isOpening = false;
  #hasOpened = false;
  /** The reason why the view is not shown. */
  #said = "";

  constructor(model: Model<StopTraits>, root: HTMLElement, signal: AbortSignal) {
    this.#model = model;
    this.#root = root;
    this.#signal = signal;
    this.button = makeButton("rw-beside-button", "", () => this.#toggle(), signal, "Beside");
  }

  /** Called whenever the bar is drawn: at the second call it is in the page. */
  update(): void {
    const isAble = this.#host.create_view !== undefined && this.#host.context?.addSibling !== undefined;
    const isOpen = this.#pane !== null;
    this.button.hidden =
      !isAble || this.#notebook === null || this.#model.get("_view") === "" || lacksKernel(this.#model);
    set(this.button, "ariaPressed", String(isOpen));
    setLabel(this.button, isOpen ? "Close the view beside the notebook" : "Show this view beside the notebook");
    const opens = this.#model.get("_opens") && this.#root.isConnected;
    setText(this.words, opens && !isAble ? CANNOT : this.#said);
    if (!opens || this.button.hidden || this.#hasOpened) return;
    this.#hasOpened = true;
    this.#open();
  }

  /** The notebook that contains the bar; null for a view next to a notebook. */
  get #notebook(): HTMLElement | null {
    return this.#root.closest<HTMLElement>(".jp-NotebookPanel");
  }

  get #host(): Host {
    return (this.#model.widget_manager ?? {}) as unknown as Host;
  }

  /** The pane of the view, for any of its bars: a notebook may be on the page twice. */
  get #pane(): Pane | null {
    const nodes = document.querySelectorAll<PaneNode>(".rw-beside-pane");
    return [...nodes].find(({ dataset }) => dataset.view === this.#model.get("_view"))?.rwPane ?? null;
  }

  #toggle(): void {
    const pane = this.#pane;
    if (pane) pane.dispose();
    else this.#open();
    this.update();
  }

  async #open(): Promise<void> {
    const [host, notebook] = [this.#host, this.#notebook];
    if (this.#isOpening || !host.create_view) return;
    const isSingle = notebook?.closest<HTMLElement>(".lm-DockPanel")?.dataset.mode === "single-document";
    this.#said = isSingle ? SINGLE : "";
    if (isSingle) return this.update();
    this.#isOpening = true;
    try {
      const view = await host.create_view(await host.get_model(this.#model.get("_view")));
      const shown = view.luminoWidget;
      if (this.#pane || this.#signal.aborted) return shown?.dispose();
      if (!shown) throw new Error("the view is not a widget of JupyterLab");
      const pane = paneFor(shown);
      const close = () => !pane.isDisposed && pane.dispose();
      view.once("remove", close);
      onAbort(this.#signal, close);
      pane.id = `robowidgets-${newName()}`;
      pane.title.label = "robot";
      pane.title.closable = true;
      pane.addClass("rw-beside-pane");
      Object.assign(pane.node, { rwPane: pane }).dataset.view = this.#model.get("_view");
      fitIn(pane.node, shown.node);
      host.context?.addSibling?.(pane, { ref: notebook?.id, mode: "split-right", type: "robowidgets" });
      if (pane.isAttached) return toClass(shown).attach(shown, pane.node);
      pane.dispose(); // a page of one notebook takes no other widget
      this.#said = CANNOT;
    } catch (error) {
      this.#said = `The view could not be put beside the notebook: ${error}`;
    } finally {
      this.#isOpening = false;
      if (!this.#signal.aborted) this.update();
    }
  }
}

/** An empty pane for a view. The element of the view is not one itself: the host sets its size by its layout. */
function paneFor(shown: Pane): Pane {
  const Widget = toClass(shown);
  const pane = new Widget();
  pane.disposed.connect(() => shown.dispose());
  return pane;
}

/** Lumino's own class, from which the class of a view is derived. */
function toClass(shown: Pane): WidgetClass {
  return Object.getPrototypeOf(shown.constructor);
}

/** Gives the view the height of its pane instead of the height of the window. */
function fitIn(pane: HTMLElement, shown: HTMLElement): void {
  shown.style.setProperty("--rw-least-height", `${LOWEST}px`);
  const fit = () => shown.style.setProperty("--rw-room-height", `${pane.clientHeight - PADDING}px`);
  new ResizeObserver(fit).observe(pane);
}
