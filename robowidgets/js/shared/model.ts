import type { AnyModel } from "@anywidget/types";

export type Model = AnyModel<Record<string, unknown>>;

/** What Python says in words about the newest sample. */
export interface About {
  frame_id?: string;
  notes?: string[];
  error?: string;
}

export function getString(model: Model, name: string): string {
  return String(model.get(name) ?? "");
}

export function getNumber(model: Model, name: string): number {
  return Number(model.get(name));
}

export function getFlag(model: Model, name: string): boolean {
  return model.get(name) === true;
}

export function getAbout(model: Model): About {
  return (model.get("_about") ?? {}) as About;
}

/** Sets traits on the page at once, and tells Python when it has time to listen. */
export function put(model: Model, values: Record<string, unknown>): void {
  for (const [name, value] of Object.entries(values)) model.set(name, value);
  model.save_changes();
}

/** Calls back on the change of any of the traits, until the signal ends it. */
export function onChange(model: Model, names: string[], callback: () => void, signal: AbortSignal): void {
  for (const name of names) model.on(`change:${name}`, callback);
  signal.addEventListener("abort", () => {
    for (const name of names) model.off(`change:${name}`, callback);
  });
}
