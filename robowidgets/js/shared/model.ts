import type { AnyModel } from "@anywidget/types";
import { onAbort } from "./events.ts";

export type Model = AnyModel<Record<string, unknown>>;

/** What Python says in words about the newest sample. */
export interface About {
  frame_id?: string;
  notes?: string[];
  error?: string;
  /** Milliseconds for which a recording has nothing newer, where that is long. */
  age?: number;
}

/** What a feed says of its topic; all of it may be missing. Plain text. */
export interface Source {
  topic?: string;
  type?: string;
  words?: string;
  /** What the program's own functions on this topic did wrong. */
  error?: string;
  /** Whether the connection is lost, so that nothing comes. */
  lost?: boolean;
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

export function getSource(model: Model): Source {
  return (model.get("_source") ?? {}) as Source;
}

/** Sets traits on the page at once, and tells Python when it has time to listen. */
export function setTraits(model: Model, values: Record<string, unknown>): void {
  for (const [name, value] of Object.entries(values)) model.set(name, value);
  model.save_changes();
}

/** Calls back on the change of any of the traits, until the signal ends it. */
export function onChange(model: Model, names: string[], callback: () => void, signal: AbortSignal): void {
  for (const name of names) model.on(`change:${name}`, callback);
  onAbort(signal, () => {
    for (const name of names) model.off(`change:${name}`, callback);
  });
}
