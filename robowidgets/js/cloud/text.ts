import { decimalsFor, toCount, toFixed, toMany, toMetres, toOrdinal } from "../shared/format.ts";
import type { PopupWords } from "../shared/popup.ts";
import { isName, quoted, toNumberCode } from "../shared/python.ts";
import { type Cloud, type Column, indexOf, isColor, placeOf } from "./cloud.ts";
import type { Selection } from "./traits.ts";

/** Units of the fields that drivers agree on. */
const UNITS: Record<string, string> = { x: "m", y: "m", z: "m", distance: "m", range: "mm" };
const LABELS: Record<string, string> = { z: "height", distance: "distance", "": "one colour" };
/** Numbers of a field that a pop-up has room for. */
const MOST_NUMBERS = 4;
const MOST_FIELDS = 9;

/** The label of a field by which points are coloured. */
export function labelOf(name: string): string {
  return LABELS[name] ?? name;
}

/** The name of a field, with its unit if that is certain: a range may have any. */
export function titleOf(name: string): string {
  return name in UNITS && name !== "range" ? `${labelOf(name)} ${UNITS[name]}` : labelOf(name);
}

/** A value as exact as it was sent, of a float32 with the digits that tell it from others. */
export function exact(value: number, values: Column): string {
  if (!(values instanceof Float32Array) || !Number.isFinite(value)) return toText(value);
  for (let digits = 6; digits < 10; digits++) {
    const rounded = Number(value.toPrecision(digits));
    if (Math.fround(rounded) === value) return toText(rounded);
  }
  return toText(value);
}

function toText(value: number): string {
  return Number.isFinite(value) ? String(value).replace("-", "\u2212") : toFixed(value, 0);
}

/** The texts of the pop-up of a point. */
export function describePoint(cloud: Cloud, i: number): PopupWords {
  const index = indexOf(cloud, i);
  const places = [cloud.x, cloud.y, cloud.z].map((column, axis) => {
    const value = column[i] as number;
    return `${"xyz"[axis]}\u00A0${toFixed(value, decimalsFor(1) + 1)}`;
  });
  const others = [...cloud.fields.values()].filter(({ name }) => !["x", "y", "z"].includes(name));
  const lines = others.slice(0, MOST_FIELDS).map(({ name, size, values }) => {
    if (isColor(name) && size === 1) return `${name} ${colorAt(values, i)}`;
    const numbers = Array.from(values.subarray(i * size, i * size + Math.min(size, MOST_NUMBERS)), (value) =>
      exact(value, values),
    );
    return `${name} ${numbers.join(", ")}${size > MOST_NUMBERS ? ", \u2026" : ""}`;
  });
  if (others.length > MOST_FIELDS) lines.push(`and ${others.length - MOST_FIELDS} more fields`);
  const [row, column] = placeOf(cloud, i);
  return {
    expression: `points[${index}]`,
    distance: toMetres(cloud.distance[i] as number),
    angle: "",
    details: [places.join("  "), ...lines].join("\n"),
    side: cloud.rows > 1 ? `row ${row}, column ${column}` : "",
  };
}

/** The colour that a depth camera packed into a number. */
function colorAt(values: Column, i: number): string {
  if (values.BYTES_PER_ELEMENT !== 4) return String(values[i]);
  const word = new Uint32Array(values.buffer, values.byteOffset)[i] ?? 0;
  return `${(word >> 16) & 0xff}, ${(word >> 8) & 0xff}, ${word & 0xff}`;
}

/** The number of points within bounds, and the number of points that were checked. */
export function countWords(cloud: Cloud, found: number, whole: number | null): string {
  if (whole !== null || cloud.step === 1) return `${toCount(whole ?? found)} of ${toMany(cloud.total, "point")}`;
  return `${toCount(found)} of ${toMany(cloud.count, "drawn point")}`;
}

/** For the footer, if points are left out: "every 4th of 100 000 points"; else "". */
export function thinnedWords(cloud: Cloud): string {
  if (cloud.step === 1) return "";
  const nth = toOrdinal(cloud.step);
  const what = cloud.rows > 1 ? `every ${nth} row and column` : `every ${nth}`;
  return `${what} of ${toMany(cloud.total, "point")} drawn`;
}

/** The bounds as words: "z 0.1 to 0.5 m, ring 3 to 7". */
export function bandWords(selection: Selection): string {
  return Object.entries(selection)
    .map(([name, [low, high]]) => {
      const unit = UNITS[name] && name !== "range" ? ` ${UNITS[name]}` : "";
      return `${name} ${toText(low)} to ${toText(high)}${unit}`;
    })
    .join("\n");
}

export const FORMS = ["points", "cloud", "array"] as const;
export type Form = (typeof FORMS)[number];
export const ABOUT_FORMS =
  "points: with each field by its name; cloud: of a robowidgets Cloud; array: of numbers of shape (N, 3)";

const AXES = ["x", "y", "z"];

/** Returns true if a selection has code in a form: an array of shape (N, 3) has no other fields. */
export function hasCode(selection: Selection, form: Form): boolean {
  return form !== "array" || Object.keys(selection).every((name) => AXES.includes(name));
}

/** The code that selects points within bounds, as Python's `CloudWidget.code` gives it. */
export function toCode(selection: Selection, form: Form): string {
  const bands = Object.entries(selection).map(([name, band]) => [name, ...band.map(toNumberCode)] as const);
  if (form === "cloud") {
    const plain = bands.filter(([name]) => isName(name)).map(([name, low, high]) => `${name}=(${low}, ${high})`);
    const others = bands
      .filter(([name]) => !isName(name))
      .map(([name, low, high]) => `${quoted(name)}: (${low}, ${high})`);
    if (others.length) plain.push(`**{${others.join(", ")}}`);
    return `cloud.points[cloud.inside(${plain.join(", ")})]`;
  }
  const parts = bands.map(([name, low, high]) => {
    const field = fieldCode(name, form);
    return `(${field} >= ${low}) & (${field} <= ${high})`;
  });
  // Bounds exclude NaN and infinite values; a distance is NaN if x, y or z is.
  const unbounded = AXES.filter((axis) => !(axis in selection || "distance" in selection));
  return `points[${[...parts, ...unbounded.map((axis) => `np.isfinite(${fieldCode(axis, form)})`)].join(" & ")}]`;
}

function fieldCode(name: string, form: Form): string {
  if (form === "array") return `points[:, ${AXES.indexOf(name)}]`;
  return isName(name) && !["points", "np"].includes(name) ? name : `points[${quoted(name)}]`;
}

/** Bounds rounded to the digits that suit a span. */
export function rounded([low, high]: [number, number], span: number): [number, number] {
  const step = 10 ** Math.floor(Math.log10(span / 500 || 1));
  const [first, last] = [low, high].map((value) => Number((Math.round(value / step) * step).toPrecision(8)));
  return [first as number, last as number];
}
