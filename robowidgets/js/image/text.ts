import { toCount, toFixed, toMany, toOrdinal } from "../shared/format.ts";
import type { PopupWords } from "../shared/popup.ts";
import { FILE, type Picture } from "./frame.ts";
import type { Statistics } from "./region.ts";
import type { ImageAbout } from "./traits.ts";

/** A value with its digits: whole numbers without decimals, others with three. */
export function toValue(value: number): string {
  return Number.isInteger(value) ? toCount(value).replace("-", "\u2212") : toFixed(value, 3);
}

/** The pixel that a text describes. */
export interface Pixel {
  row: number;
  column: number;
}

/** The known values of a pixel. */
export interface Known {
  values: number[];
  /** True if they are the values of the message. */
  isExact: boolean;
  /** True if they are red, green and blue as shown, not the channels of the message. */
  isShown?: boolean;
}

/** "every 2nd row and column", or nothing. */
export function thinned({ every }: Pick<Picture, "every">): string {
  return every > 1 ? `every ${toOrdinal(every)} row and column` : "";
}

/** The reasons why the shown values differ from the message. */
function reasons(picture: Picture, { isExact, isShown = false }: Omit<Known, "values">, of: string): string[] {
  if (isExact) return [];
  const isFile = picture.form === FILE;
  const shown = `as shown (8 bit)${isFile ? ", from a JPEG" : ""}`;
  const why = isShown ? shown : isFile ? "about, from a JPEG" : "rounded to float32";
  return [picture.every > 1 ? `${of} ${thinned(picture)}` : "", picture.isExact ? "" : why].filter(Boolean);
}

/** The letters of the channels whose values are known. */
function lettersOf(isShown: boolean | undefined, { channels = "" }: ImageAbout): string {
  return isShown ? "rgba" : channels;
}

/** Metres in the frame of the camera: x to the right, y down, z ahead. */
export function toCamera({ row, column }: Pixel, depth: number, [fx = 1, fy = 1, cx = 0, cy = 0]: number[]): number[] {
  return [((column - cx) * depth) / fx, ((row - cy) * depth) / fy, depth];
}

/** The texts of the pop-up of a pixel. */
export function describePixel(
  pixel: Pixel,
  known: Known | null,
  picture: Picture,
  about: ImageAbout,
  camera: number[] | null,
): PopupWords {
  const { row, column } = pixel;
  const name = picture.depthScale ? "image.depth" : "image";
  const lines: string[] = [];
  const { row_bytes, pixel_bytes } = about;
  if (row_bytes && pixel_bytes) lines.push(`data[${row * row_bytes + column * pixel_bytes}]`);
  if (camera && picture.depthScale && known?.values[0]) {
    const [x = NaN, y = NaN, z = NaN] = toCamera(pixel, known.values[0], camera);
    if (!Number.isNaN(z)) lines.push(`x ${toFixed(x, 3)}  y ${toFixed(y, 3)}  z ${toFixed(z, 3)} m`);
  }
  if (known) lines.push(...reasons(picture, known, "nearest of"));
  return {
    expression: `${name}[${row}, ${column}]`,
    distance: known ? toValues(known.values, picture, lettersOf(known.isShown, about)) : "\u2026",
    details: lines.join("\n"),
  };
}

/** The values of a pixel with the letters of their channels; for a depth image the distance. */
function toValues(values: number[], { depthScale }: Picture, letters: string): string {
  if (depthScale) return Number.isNaN(values[0] ?? NaN) ? "nothing" : `${toFixed(values[0] ?? NaN, 3)} m`;
  const several = values.length > 1 ? letters : "";
  return values.map((value, i) => `${several[i] ?? ""} ${toValue(value)}`.trim()).join("  ");
}

/** The code that reads a region. */
export function toCode([top, bottom, left, right]: readonly number[], isDepth: boolean): string {
  return `${isDepth ? "image.depth" : "image"}[${top}:${bottom}, ${left}:${right}]`;
}

/** The texts of the pop-up of a region. */
export function describeRegion(
  region: readonly number[],
  found: Statistics | null,
  picture: Picture,
  about: ImageAbout,
): PopupWords {
  const [top = 0, bottom = 0, left = 0, right = 0] = region;
  const words = {
    expression: toCode(region, picture.depthScale > 0),
    distance: `${toCount(bottom - top)} \u00D7 ${toCount(right - left)}`,
  };
  if (!found) return { ...words, details: "\u2026" };
  const unit = picture.depthScale ? " m" : "";
  const letters = found.channels.length > 1 ? lettersOf(found.isShown, about) : "";
  const show = (value: number) =>
    picture.depthScale ? toFixed(value, 3) : Number.isInteger(value) ? toValue(value) : toFixed(value, 1);
  const rows = found.channels.map((row, i) => {
    if (!row) return `${letters[i] ?? ""} nothing`.trim();
    const [least, mean, median, most] = row.map(show);
    return `${letters[i] ?? ""} ${least} to ${most}${unit}, mean ${mean}, median ${median}`.trim();
  });
  const lacks = found.of - found.count;
  if (lacks > 0) rows.push(`${toMany(lacks, "pixel")} of ${toCount(found.of)} nothing`);
  rows.push(...reasons(picture, found, "of"));
  return { ...words, details: rows.join("\n") };
}
