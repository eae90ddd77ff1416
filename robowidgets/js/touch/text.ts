import { toCount, toFixed } from "../shared/format.ts";
import type { Sensor, TouchState } from "../shared/frames/touch.ts";

/** From more sensors on, the words that their names share are shown. */
const MANY = 4;

const MODES: Record<string, string> = { event: "events", level: "level", presence: "presence" };

/** The mode of a source, for the header. */
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
 * The text next to the state: the duration of a touch, else the number of touches.
 * @param elapsed seconds since the state was sent, or null if unknown
 */
export function detailOf({ state, touches, seconds }: Sensor, elapsed: number | null): string {
  if (state === "touched" && elapsed !== null) return toDuration((seconds ?? 0) + elapsed);
  return state === "unknown" && touches === 0 ? "\u2014" : toTouches(touches);
}

/** All facts about a sensor, in one sentence. */
export function tellAll({ name, state, touches, seconds }: Sensor, elapsed: number | null): string {
  const lasting = seconds === null || elapsed === null ? "" : ` for ${toDuration(seconds + elapsed)}`;
  const since = seconds === null ? "not known yet" : `${state}${lasting}`;
  return `${name}: ${since}, ${toTouches(touches)} so far`;
}

/** Touched sensors that are not on show: "also touched: center". */
export function tellBeside(all: Sensor[], shown: Sensor[]): string {
  const there = new Set(shown.map(({ name }) => name));
  const names = all.filter(({ name, state }) => state === "touched" && !there.has(name)).map(({ name }) => name);
  return names.length ? `also touched: ${names.join(", ")}` : "";
}

/** The number of sensors in each state, and of all touches together. */
export function summarize(sensors: Sensor[]): { counts: Record<TouchState, number>; touches: number } {
  const counts: Record<TouchState, number> = { touched: 0, free: 0, unknown: 0 };
  for (const { state } of sensors) counts[state] += 1;
  return { counts, touches: sensors.reduce((sum, sensor) => sum + sensor.touches, 0) };
}

/** Words of a name, each with the separator after it. */
const WORDS = /[^_\-\s./:]*(?:[_\-\s./:]+|$)/g;

/**
 * A label for each name: of names in scopes, as simulators have them ("robot::base::bumper"), the last parts that
 * distinguish it from the others; then without the words with which all start or end.
 */
export function toLabels(names: string[], given: Record<string, string>): string[] {
  const labels = withoutShared(lastParts(names));
  return names.map((name, i) => given[name] ?? (labels[i] as string));
}

/** The words that many names share, to be shown once: "robot::base::bumper_…"; "" if labels do not end like names. */
export function toShared(names: string[], labels: string[]): string {
  const [name = "", label = ""] = [names[0], labels[0]];
  const start = name.slice(0, name.lastIndexOf(label));
  const end = name.slice(start.length + label.length);
  const isShared = names.every((other, i) => other === start + labels[i] + end);
  return names.length > MANY && isShared && start + end ? `${start}\u2026${end}` : "";
}

/** Names without the words with which all start or end: at least one word of each remains. */
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

/** The last parts of names in scopes that distinguish them. */
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
