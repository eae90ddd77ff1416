import type { Shape, Spot } from "../traits.ts";

/** A place in metres in the frame of the scanner: x forward, y to the left. */
export type Metres = [x: number, y: number];

const TURN = 2 * Math.PI;
/** Radians of an arc that one straight piece of its picture spans. */
const PIECE = Math.PI / 90;

/** The places of a shape in metres, or null if one is a ray without a reading. */
export function placesOf(at: Spot[], readingOf: (index: number) => Metres | null): Metres[] | null {
  const places = at.map((spot) => (typeof spot === "number" ? readingOf(spot) : spot));
  return places.every((place) => place !== null) ? places : null;
}

/** The places along an arc, from its first angle counter-clockwise to its second. */
export function arcPlaces({ start = 0, end = TURN, radius = 0 }: Shape, [x, y]: Metres): Metres[] {
  const turned = end - start >= TURN ? TURN : (((end - start) % TURN) + TURN) % TURN;
  const pieces = Math.max(1, Math.ceil(turned / PIECE));
  return Array.from({ length: pieces + 1 }, (_, i) => {
    const angle = start + (turned * i) / pieces;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });
}

/** Returns true if an arc is a whole circle, which has no ends. */
export function isCircle({ start = 0, end = TURN }: Shape): boolean {
  return end - start >= TURN - 1e-9;
}
