/**
 * Draws widgets in their states, and writes down what they show. Reads a list of states from the standard input and
 * writes a text for each to the standard output.
 */

import { readFileSync, writeFileSync } from "node:fs";
import { FakeModel } from "../models.ts";
import { clock, describe, document, picture } from "./page.ts";

interface Step {
  /** Milliseconds that pass. */
  pass?: number;
  /** The event, at a place of the picture or on the element of a selector. */
  event?: string;
  on?: string;
  at?: [number, number];
  key?: string;
}

interface Look {
  /** The script of the widget, such as "laser_widget". */
  script: string;
  traits: Record<string, unknown>;
  width: number;
  height: number;
  theme: "light" | "dark";
  steps: Step[];
}

const JS = new URL("../../../robowidgets/js/", import.meta.url);
const STATIC = new URL("../../../robowidgets/static/", import.meta.url);

/** A value from Python: bytes are in base64. */
function revive(_: string, value: unknown): unknown {
  const base64 = (value as { base64?: string } | null)?.base64;
  if (base64 === undefined) return value;
  const bytes = Uint8Array.from(Buffer.from(base64, "base64"));
  return new DataView(bytes.buffer);
}

function act({ event = "", on = ".rw-picture", at, key = "" }: Step): void {
  const target = document.querySelector<HTMLElement>(on);
  if (!target) throw new Error(`nothing matches ${on}`);
  if (event === "click" && !at) {
    target.click();
    return;
  }
  const [clientX = 0, clientY = 0] = at ?? [];
  const init = { bubbles: true, clientX, clientY, button: 0, pointerId: 1, isPrimary: true, pointerType: "mouse", key };
  const Made = event.startsWith("key") ? KeyboardEvent : event.startsWith("pointer") ? PointerEvent : MouseEvent;
  const made = new Made(event, init);
  // happy-dom leaves out what a mouse has.
  for (const [name, value] of Object.entries({ clientX, clientY, offsetX: clientX, offsetY: clientY, pointerId: 1 }))
    if (!event.startsWith("key")) Object.defineProperty(made, name, { value });
  target.dispatchEvent(made);
}

async function draw(look: Look): Promise<string[]> {
  clock.now = 1000;
  Object.assign(picture, { width: look.width, height: look.height });
  document.body.dataset.jpThemeLight = String(look.theme === "light");
  document.head.replaceChildren();
  const style = document.createElement("style");
  style.textContent = readFileSync(new URL(`${look.script}.css`, STATIC), "utf8");
  document.head.append(style);
  const element = document.createElement("div");
  element.id = "view";
  document.body.replaceChildren(element);
  const { default: make } = await import(new URL(`${look.script}.ts`, JS).href);
  const widget = typeof make === "function" ? make() : make;
  const { model } = new FakeModel(look.traits);
  const ends = new AbortController();
  const { signal } = ends;
  await widget.initialize?.({ model, signal });
  await widget.render({ model, el: element, signal });
  await clock.pass(300);
  for (const step of look.steps) {
    if (step.event) act(step);
    await clock.pass(step.pass ?? 300);
  }
  const lines = [...document.body.children].flatMap((child) => [...child.children].flatMap((card) => describe(card)));
  ends.abort();
  clock.clear();
  return lines;
}

const looks = JSON.parse(readFileSync(0, "utf8"), revive) as Look[];
const texts: string[][] = [];
for (const look of looks) texts.push(await draw(look));
writeFileSync(1, JSON.stringify(texts));
process.exit(0);
