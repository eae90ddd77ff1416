type Callback = (...given: unknown[]) => void;
type State = Record<string, unknown>;

const isBinary = (value: unknown) => ArrayBuffer.isView(value) || value instanceof ArrayBuffer;

function isSame(a: unknown, b: unknown): boolean {
  if (a === b) return true;
  return !isBinary(a) && !isBinary(b) && JSON.stringify(a) === JSON.stringify(b);
}

/** A widget's model without a kernel: only its view and other models of the page change it. */
export class PageModel {
  readonly widget_manager: { get_model(id: string): Promise<unknown> };
  readonly #state: State;
  readonly #callbacks = new Map<string, Set<Callback>>();

  /** @param models all models of the page, by their ids */
  constructor(state: State, models: Map<string, PageModel>) {
    this.#state = state;
    this.widget_manager = { get_model: async (id) => models.get(id) };
  }

  // biome-ignore lint/suspicious/noExplicitAny: each widget has traits of its own.
  get(name: string): any {
    return this.#state[name];
  }

  set(name: string, value: unknown): void {
    this.set_state({ [name]: value });
  }

  set_state(state: State): void {
    const changed = Object.keys(state).filter((name) => !isSame(this.#state[name], state[name]));
    Object.assign(this.#state, state);
    for (const name of changed) this.fire(`change:${name}`);
  }

  save_changes(): void {}

  /** Sends a message to Python; a page's code that answers instead listens to "sent". */
  send(content: unknown): void {
    this.fire("sent", content);
  }

  on(event: string, callback: Callback): void {
    this.#callbacks.set(event, (this.#callbacks.get(event) ?? new Set()).add(callback));
  }

  off(event: string, callback: Callback): void {
    this.#callbacks.get(event)?.delete(callback);
  }

  fire(event: string, ...given: unknown[]): void {
    for (const callback of [...(this.#callbacks.get(event) ?? [])]) callback(...given);
  }
}
