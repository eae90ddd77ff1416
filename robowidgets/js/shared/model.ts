import { onAbort } from "./events.ts";

/**
 * A widget's model, as anywidget hands it over.
 *
 * T lists the synced traits of Python's widget, by name and type: `traits.ts` of each widget, which
 * tests/unit/test_contract.py holds against the Python classes. A `change:` callback takes no arguments.
 */
export interface Model<T> {
  get<K extends keyof T>(name: K): T[K];
  /** The layout of ipywidgets: a model of the host, or another host's substitute for it. */
  get(name: "layout"): { comm_live?: boolean } | null | undefined;
  set<K extends keyof T>(name: K, value: T[K]): void;
  save_changes(): void;
  send(content: unknown): void;
  on(event: ChangeOf<T>, callback: () => void): void;
  on(event: "msg:custom", callback: OnMessage): void;
  off(event: ChangeOf<T>, callback: () => void): void;
  off(event: "msg:custom", callback: OnMessage): void;
  readonly widget_manager: { get_model(id: string): Promise<unknown> };
}

type ChangeOf<T> = `change:${keyof T & string}`;
// biome-ignore lint/suspicious/noExplicitAny: each widget has messages of its own.
type OnMessage = (content: any, buffers: DataView[]) => void;

/** The arguments of a widget's script once per model. The signal aborts when the model is closed. */
export interface Initialized<T> {
  model: Model<T>;
  signal: AbortSignal;
}

/** The arguments of a widget's script once per view. */
export interface Rendered<T> extends Initialized<T> {
  el: HTMLElement;
}

/** The page around a widget, as anywidget 0.11 hands it to a view. A reference is `anywidget:` and the id of a model. */
export interface Host {
  getWidget(reference: string): Promise<{ render(given: { el: HTMLElement; signal: AbortSignal }): unknown }>;
}

/** The arguments of the script of a widget that holds others. */
export interface Hosted<T> extends Rendered<T> {
  /** Missing before anywidget 0.11. */
  host?: Host;
}

/**
 * A name that no other view of any page has. `crypto.randomUUID` is missing in a page that is served over plain http.
 */
export function newName(): string {
  return crypto.getRandomValues(new Uint32Array(2)).join("");
}

/** The text of a picture if no kernel will ever answer. */
export const NO_KERNEL = "no kernel in this page";

/**
 * Returns true if Python cannot be reached: the page was exported, or its kernel has ended. Hosts hand out a model
 * without its comm, but with its layout, a model of the host with the same kernel; a host without either has a kernel.
 */
export function lacksKernel<T>(model: Pick<Model<T>, "get">): boolean {
  return model.get("layout")?.comm_live === false;
}

/** Sets traits in the page at once and sends them to Python, which may be busy. */
export function setTraits<T>(model: Model<T>, values: Partial<T>): void {
  for (const name in values) model.set(name, values[name] as T[typeof name]);
  model.save_changes();
}

/** Calls back when any of the traits changes, until the signal aborts. */
export function onChange<T>(
  model: Pick<Model<T>, "on" | "off">,
  names: readonly (keyof T & string)[],
  callback: () => void,
  signal: AbortSignal,
): void {
  for (const name of names) model.on(`change:${name}`, callback);
  onAbort(signal, () => {
    for (const name of names) model.off(`change:${name}`, callback);
  });
}

/** Calls back on custom messages from Python, until the signal aborts. */
export function onMessage<T, M>(
  model: Model<T>,
  callback: (message: M, buffers: DataView[]) => void,
  signal: AbortSignal,
): void {
  model.on("msg:custom", callback);
  onAbort(signal, () => model.off("msg:custom", callback));
}
