import type { Model } from "../../robowidgets/js/shared/model.ts";

/** A model as anywidget hands it over, without Jupyter: it remembers, calls back and notes what would be sent. */
export class FakeModel {
  readonly saved: Record<string, unknown>[] = [];
  readonly #values: Record<string, unknown>;
  readonly #callbacks = new Map<string, Set<(...given: unknown[]) => void>>();
  #changed: Record<string, unknown> = {};

  constructor(values: Record<string, unknown> = {}) {
    this.#values = values;
  }

  get(name: string): unknown {
    return this.#values[name];
  }

  set(name: string, value: unknown): void {
    this.#changed[name] = value;
    this.receive({ [name]: value });
  }

  save_changes(): void {
    this.saved.push(this.#changed);
    this.#changed = {};
  }

  on(event: string, callback: () => void): void {
    this.#callbacks.set(event, (this.#callbacks.get(event) ?? new Set()).add(callback));
  }

  off(event: string, callback: () => void): void {
    this.#callbacks.get(event)?.delete(callback);
  }

  /** One message of Python: all its traits are set before anybody is called. */
  receive(values: Record<string, unknown>): void {
    const changed = Object.keys(values).filter((name) => this.#values[name] !== values[name]);
    Object.assign(this.#values, values);
    for (const name of changed) for (const callback of this.#callbacks.get(`change:${name}`) ?? []) callback();
  }

  /** A message of Python that is no trait. */
  tell(content: unknown, buffers: DataView[] = []): void {
    for (const callback of this.#callbacks.get("msg:custom") ?? []) callback(content, buffers);
  }

  /** How many callbacks there are. */
  get listening(): number {
    return [...this.#callbacks.values()].reduce((sum, callbacks) => sum + callbacks.size, 0);
  }

  get model(): Model<never> {
    return this as unknown as Model<never>;
  }
}
