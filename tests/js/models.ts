import type { Model } from "../../robowidgets/js/shared/model.ts";

/**
 * A model as anywidget hands it over, without Jupyter: it keeps values, calls back and records the messages to Python.
 */
export class FakeModel {
  readonly saved: Record<string, unknown>[] = [];
  readonly sent: unknown[] = [];
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

  send(content: unknown): void {
    this.sent.push(content);
  }

  on(event: string, callback: () => void): void {
    this.#callbacks.set(event, (this.#callbacks.get(event) ?? new Set()).add(callback));
  }

  off(event: string, callback: () => void): void {
    this.#callbacks.get(event)?.delete(callback);
  }

  /** Sets all traits of one message of Python, then calls back. */
  receive(values: Record<string, unknown>): void {
    const changed = Object.keys(values).filter((name) => this.#values[name] !== values[name]);
    Object.assign(this.#values, values);
    for (const name of changed) for (const callback of this.#callbacks.get(`change:${name}`) ?? []) callback();
  }

  /** Sends a custom message of Python. */
  tell(content: unknown, buffers: DataView[] = []): void {
    for (const callback of this.#callbacks.get("msg:custom") ?? []) callback(content, buffers);
  }

  /** Number of callbacks. */
  get listening(): number {
    return [...this.#callbacks.values()].reduce((sum, callbacks) => sum + callbacks.size, 0);
  }

  get model(): Model<never> {
    return this as unknown as Model<never>;
  }
}
