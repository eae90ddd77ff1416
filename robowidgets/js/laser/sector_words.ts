import { type AngleUnit, toAngle, toMany, toMetres } from "../shared/format.ts";
import { isFullCircle, READING, type Scan, type Sweep } from "../shared/frames/scan.ts";
import type { ChipTexts } from "./chip.ts";
import type { ToShown } from "./mount.ts";
import { type Measured, parseRays, type Sector, type State, type Stretch, sectorOf, toExpression } from "./sector.ts";
import type { Named } from "./sector_store.ts";

/** Metres to the nearest thing, or a word without a number. */
function toDistance({ distance }: Measured, reach: number): string {
  if (distance === Infinity) return "nothing";
  return Number.isNaN(distance) ? "unknown" : distance === 0 ? "too close" : toMetres(distance, reach);
}

/** The lines on a sector: its name, with its state, and its distance. */
export function toLines({ name }: Named, measured: Measured, state: State, reach: number): string[] {
  const isSaid = state !== "" && state !== "free" && state !== "unknown";
  return [isSaid ? `${name} \u00B7 ${state}` : name, toDistance(measured, reach)];
}

/**
 * @param reach metres of the picture, which set the decimals
 * @param unit in which angles are shown
 * @param toShown converts to the angles on show
 */
export function describeSector(
  { name, sector }: Named,
  scan: Scan,
  stretches: Stretch[],
  measured: Measured,
  state: State,
  reach: number,
  unit: AngleUnit,
  toShown: ToShown = (angle) => angle,
): ChipTexts {
  const { nearest, median, valid, count } = measured;
  const ends = [toShown(sector.start), toShown(sector.end)] as const;
  // Upside down, the scanner counts the other way round.
  const [from, to] = toShown(1) < toShown(0) ? [ends[1], ends[0]] : ends;
  return {
    name,
    expression: toExpression(stretches, scan.count) || "no rays",
    state: state === "free" ? "" : state,
    angles: `${toAngle(from, unit)} to ${toAngle(to, unit)}`,
    distance: toDistance(measured, reach),
    nearest: nearest < 0 ? "" : scan.kinds[nearest] === READING ? "nearest" : "at",
    index: nearest < 0 ? "" : `[${nearest}]`,
    median: `median ${Number.isNaN(median) ? "\u2014" : toMetres(median, reach)}`,
    valid: `${valid} of ${count} valid`,
  };
}

/** The text of a sector for a screen reader. */
export function sayOf(texts: ChipTexts): string[] {
  const { name, state, expression, distance, nearest, index, valid } = texts;
  return [name, state, expression, `${nearest} ${index} ${distance}`.trim(), valid];
}

/** The sector of the rays that a text names, or an error text. */
export function sectorOfText(sweep: Sweep, text: string): Sector | string {
  const { count } = sweep;
  const stretches = parseRays(text, count);
  if (!stretches) return "expected a slice, as ranges[240:300]";
  const isBeyond = stretches.some(([from, to]) => from < 0 || to > count || from >= count);
  if (isBeyond) return `this scan has ${toMany(count, "ray")}${count ? `, the last is ranges[${count - 1}]` : ""}`;
  if (stretches.some(([from, to]) => from >= to)) return "no ray is in this slice";
  const [[first, stop] = [0, 0]] = stretches;
  let last = stop - 1;
  for (const [from, to] of stretches.slice(1)) {
    // On across the seam.
    if (from !== 0 || last !== sweep.count - 1 || !isFullCircle(sweep)) return "these rays are not one sector";
    last += to;
  }
  return sectorOf(sweep, first, last);
}
