import { readFileSync } from "node:fs";
import type { Limits } from "../../robowidgets/js/speed/traits.ts";

/** A number, or a word that stands for one that JSON has not. */
export type Word = number | "nan" | "inf" | "-inf";

interface Vectors {
  limits: [Word, Limits, string][];
  frame: {
    measured: Word[];
    commanded: Word[];
    least: Word[];
    greatest: Word[];
    sequence: number;
    resets: number;
    base64: string;
  };
}

/** The cases that Python's tests read too. */
export const vectors: Vectors = JSON.parse(readFileSync(new URL("../vectors/speed.json", import.meta.url), "utf8"));

export function toSpeed(word: Word): number {
  return { nan: NaN, inf: Infinity, "-inf": -Infinity }[word] ?? Number(word);
}
