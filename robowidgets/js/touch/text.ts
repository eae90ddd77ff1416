import { toCount, toFixed } from "../shared/format.ts";
import type { Sensor, TouchState } from "../shared/frames/touch.ts";

/** From more sensors on, the words that their names share are shown. */
const MANY = 4;

const MODES: Record<string, string> = { event: "events", level: "level", presence: "presence" };

/** How a source speaks, for the header. */
export function modeWord(mode: string | undefined): string {
  return MODES[mode ?? ""] ?? "";
}

/** "1 touch", "3 touches". */
export function toTouches(count: number): string {
  return `${toCount(count)} ${count === 1 ? "touch" : "touches"}`;
}

/** "1.2 s", "1 min 05 s", "2 h 07 min". */
export function toDuration(seconds: number): string {
  // Rounded first: 59.96 s are a minute and not "60.0 s".
  if (Math.round(seconds * 10) < 600) return `${toFixed(seconds, 1)} s`;
  const whole = Math.round(seconds);
  const two = (value: number) => String(Math.floor(value)).padStart(2, "0");
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${two(whole % 60)} s`;
  return `${Math.floor(whole / 3600)} h ${two((whole % 3600) / 60)} min`;
}

/**
 * What is said beside the state: how long a touch lasts, else how many there were.
 * @param elapsed seconds since the state was sent; null when nobody knows
 */
export function detailOf({ state, touches, seconds }: Sensor, elapsed: number | null): string {
  if (state === "touched" && elapsed !== null) return toDuration((seconds ?? 0) + elapsed);
  return state === "unknown" && touches === 0 ? "\u2014" : toTouches(touches);
}

/** All that is known of a sensor, in one sentence. */
export function tellAll({ name, state, touches, seconds }: Sensor, elapsed: number | null): string {
  const lasting = seconds === null || elapsed === null ? "" : ` for ${toDuration(seconds + elapsed)}`;
  const since = seconds === null ? "not known yet" : `${state}${lasting}`;
  return `${name}: ${since}, ${toTouches(touches)} so far`;
}

/** Which sensors are touched that are not on show: "also touched: center". */
export function tellBeside(all: Sensor[], shown: Sensor[]): string {
  const there = new Set(shown.map(({ name }) => name));
  const names = all.filter(({ name, state }) => state === "touched" && !there.has(name)).map(({ name }) => name);
  return names.length ? `also touched: ${names.join(", ")}` : "";
}

/** How many sensors are in each state, and all touches together. */
export function summarize(sensors: Sensor[]): { counts: Record<TouchState, number>; touches: number } {
  const counts: Record<TouchState, number> = { touched: 0, free: 0, unknown: 0 };
  for (const { state } of sensors) counts[state] += 1;
  return { counts, touches: sensors.reduce((sum, sensor) => sum + sensor.touches, 0) };
}

/** Words of a name, each with what joins it to the next: "left_", "front". */
const WORDS = /[^_\-\s./:]*(?:[_\-\s./:]+|$)/g;

/**
 * A label for each name: of names in scopes, as simulators have them ("robot::base::bumper"), the last parts that tell
 * it from the others; and of those without the words that all start or end with.
 */
export function toLabels(names: string[], given: Record<string, string>): string[] {
  const labels = withoutShared(lastParts(names));
  return names.map((name, i) => given[name] ?? (labels[i] as string));
}

/** The words that many names share, to be shown once: "robot::base::bumper_…"; empty if labels do not end like names. */
export function toShared(names: string[], labels: string[]): string {
  const [name = "", label = ""] = [names[0], labels[0]];
  const start = name.slice(0, name.lastIndexOf(label));
  const end = name.slice(start.length + label.length);
  const isShared = names.every((other, i) => other === start + labels[i] + end);
  return names.length > MANY && isShared && start + end ? `${start}\u2026${end}` : "";
}

/** What is left of names without the words that all start or end with: at least one word of each. */
function withoutShared(names: string[]): string[] {
  const split = names.map((name) => name.match(WORDS)?.filter(Boolean) ?? []);
  const [first = []] = split;
  const least = Math.min(...split.map((words) => words.length)) - 1;
  if (new Set(names).size < 2) return names;
  const isShared = (at: number) => split.every((words) => words.at(at) === first.at(at));
  let start = 0;
  while (start < least && isShared(start)) start++;
  let end = 0;
  while (start + end < least && isShared(-1 - end)) end++;
  return split.map((words) => {
    const rest = words.slice(start, words.length - end).join("");
    return end ? rest.replace(/[_\-\s./:]+$/, "") : rest;
  });
}

/** The last parts of names in scopes that tell them from each other. */
function lastParts(names: string[]): string[] {
  return names.map((name) => {
    const parts = name.split("::");
    for (let count = 1; count < parts.length; count += 1) {
      const short = parts.slice(-count).join("::");
      if (names.every((other) => other === name || !`::${other}`.endsWith(`::${short}`))) return short;
    }
    return name;
  });
}
