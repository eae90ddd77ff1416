import { sideOf, toCount, toDegrees, toFixed, toMany, toMetres } from "../shared/format.ts";
import { meaningOf } from "../shared/frames/classes.ts";
import { NO_MEASUREMENT, NOTHING_IN_RANGE, OUTSIDE_LIMITS, READING, TOO_CLOSE } from "../shared/frames/scan.ts";
import type { PopupWords } from "../shared/popup.ts";
import { nameOf, type StateSpan, toWords as toPath } from "../shared/states/states.ts";
import { toSeconds } from "../shared/time_span.ts";
import type { Place } from "./blocks.ts";
import { kindOf, type NamedSpan, type Sweep, type Whole } from "./data.ts";
import type { Pixel } from "./traits.ts";

const SYMBOLS: Record<number, string> = {
  [TOO_CLOSE]: "\u2212inf",
  [NOTHING_IN_RANGE]: "+inf",
  [NO_MEASUREMENT]: "NaN",
  [OUTSIDE_LIMITS]: "outside",
};

/** The texts of the pop-up of a ray at a moment. */
export function describePlace(place: Place, angle: number, sweep: Sweep, pixel: Pixel = "nearest"): PopupWords {
  const kind = kindOf(place.code);
  const known = kind === OUTSIDE_LIMITS && place.exact ? `${toFixed(place.range, 3)} m` : SYMBOLS[kind];
  const lines = [meaningOf({ kinds: [kind], ...sweep }, 0), toMoment(place), sharedBy(place, pixel)];
  return {
    expression: sweep.byAngle ? "" : `ranges[${place.index}]`,
    distance: kind === READING ? toMetres(place.range, sweep.far) : (known ?? ""),
    angle: toDegrees(angle),
    details: lines.filter(Boolean).join("\n"),
    side: sideOf(angle),
  };
}

function toMoment({ scan, scans, time }: Place): string {
  if (scans > 1) return `from ${toSeconds(time)}`;
  return scan === null ? toSeconds(time) : `${toSeconds(time)}  scan ${toCount(scan)}`;
}

/** The texts of the pop-up of a moment between the parts of the drive that were read. */
export function describeUnread(time: number): PopupWords {
  return { expression: "", distance: "not read", details: `${toSeconds(time)}\nno scan here was read yet` };
}

/**
 * The number of scans and rays that share a pixel, for which this is the nearest, or the median; "" for a single
 * measurement.
 */
function sharedBy({ scans, rays, code }: Place, pixel: Pixel): string {
  if (scans === 1 && rays === 1) return "";
  const parts = [scans > 1 ? toMany(scans, "scan") : "", rays > 1 ? toMany(rays, "ray") : ""].filter(Boolean);
  const kind = kindOf(code);
  const isNearest = kind === READING || kind === TOO_CLOSE;
  // Of several without a reading, the one that says most is shown; only "nothing" is what all of them have.
  const one = pixel !== "nearest" || isNearest ? pixel : kind === NOTHING_IN_RANGE ? "all" : "one or more";
  return `${one} of ${parts.join(", ")}`;
}

/** A share of all rays: "9 %". A small share is never "0 %". */
export function toShare(count: number, all: number): string {
  if (count === 0 || all === 0) return "0 %";
  const percent = (100 * count) / all;
  if (percent < 0.1) return "< 0.1 %";
  if (percent < 1) return `${toFixed(percent, 1)} %`;
  return `${toFixed(count < all ? Math.min(99, percent) : 100, 0)} %`;
}

/** "selection 38.00 – 52.50 s · 73 scans" without the first word. */
export function describeSelection(
  selection: number[],
  scans: { scans: number; exact: boolean },
  isThinned = false,
): string {
  const [start = 0, end = 0, first, stop] = selection;
  const rays = first === undefined || stop === undefined ? "" : ` · [${first}] to [${stop - 1}]`;
  return `${toFixed(start, 2)} \u2013 ${toSeconds(end)}${rays} · ${scans.exact ? "" : "about "}${toMany(scans.scans, "scan")}${isThinned ? " read" : ""}`;
}

/** The texts of the pop-up of one axis of the speed at a moment. */
export function describeSpeed(axis: string, title: string, low: number, high: number, time: number): PopupWords {
  const unit = axis.startsWith("linear") ? "m/s" : "rad/s";
  const value = low === high ? toFixed(low, 2) : `${toFixed(low, 2)} to ${toFixed(high, 2)}`;
  const words = Number.isNaN(low) ? "no value" : `${value} ${unit}`;
  return { expression: axis, distance: words, details: `${toSeconds(time)}  ${title}` };
}

/** The texts of the pop-up of the touches at a moment. */
export function describeTouches(touches: NamedSpan[], title: string, time: number): PopupWords {
  const sensors = [...new Set(touches.map(({ name }) => name))];
  const spans = touches.map(toWords);
  return {
    expression: title,
    distance: sensors.length ? "touched" : "not touched",
    details: sensors.length ? `${sensors.join(", ")}\n${spans[0]}` : toSeconds(time),
  };
}

/** The texts of the pop-up of a mark. */
export function describeMark(mark: NamedSpan): PopupWords {
  return { expression: mark.name, distance: toWords(mark), details: "marked" };
}

/** The texts of the pop-up of a state. */
export function describeState([start, end, path]: StateSpan): PopupWords {
  return { expression: toPath(path), distance: nameOf(path), details: toWords({ start, end, name: "" }) };
}

function toWords({ start, end }: NamedSpan): string {
  return `${toFixed(start, 2)} \u2013 ${toSeconds(end)}`;
}

/** Facts about the whole recording for the header. */
export function toFacts({ scanCount, driveScans, sweep, span }: Whole): string[] {
  const scans = driveScans === undefined ? "" : `${toCount(scanCount)} of `;
  return [
    `${scans}${toMany(driveScans ?? scanCount, "scan")}`,
    toMany(sweep.count, "ray"),
    toSeconds(span[1] - span[0], 1),
  ];
}
