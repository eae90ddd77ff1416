import { type Box, holds, isWithin, overlaps } from "../shared/box.ts";
import { clipToFloor, floorOf, type Place, type Projection, toPixel } from "../shared/floor.ts";
import { drawShape, pathOf } from "../shared/shapes/draw.ts";
import { boxAt, LINE, PLACES, widthOf, writeLabel } from "../shared/shapes/labels.ts";
import { type Metres, placesOf } from "../shared/shapes/places.ts";
import type { Theme } from "../shared/theme.ts";
import { endOf, robotRadius, type Scene, toPlace, turnedBy } from "./scene.ts";
import type { RoomShape } from "./traits.ts";

/** Draws the shapes of programs on the newest scan, at their places on the floor; their names stand next to them. */
export function drawShapes(
  context: CanvasRenderingContext2D,
  projection: Projection,
  { scan, robot }: Scene,
  shapes: RoomShape[],
  theme: Theme,
): void {
  const floor = floorOf(projection);
  const drawn = shapes.flatMap((shape) => {
    const seen = turnedBy(scan, shape.turned);
    const toPoint = (place: Metres) => toPixel(projection, toPlace(seen, place));
    const places = placesOf(shape.at, (index) => (Number.isFinite(seen.ranges[index]) ? endOf(seen, index) : null));
    const isOnFloor = (point: Place) => holds(floor, point);
    return places ? [{ shape, places, toPoint, path: pathOf(toPoint, isOnFloor, shape, places) }] : [];
  });
  clipToFloor(context, projection, () => {
    for (const { shape, places, toPoint } of drawn) drawShape(context, toPoint, shape, places, theme);
  });

  const paths = drawn.flatMap(({ shape, path }) => (shape.kind === "text" ? [] : path));
  const taken = [boxOf(toPixel(projection, robot), robotRadius(projection, robot))];
  const isFree = (box: Box) =>
    isWithin(box, floor) && !taken.some((other) => overlaps(box, other, 2)) && !paths.some((at) => holds(box, at));
  const named = new Set<string>();
  for (const { shape, path } of drawn) {
    const isText = shape.kind === "text";
    if (!isText && named.has(shape.name)) continue;
    named.add(shape.name);
    const text = (isText && shape.text) || shape.name;
    const width = widthOf(context, text, 0, theme);
    for (let place = 0; place < PLACES; place++) {
      const box = boxAt(path, width, LINE, place, isText);
      if (!box || !isFree(box)) continue;
      taken.push(box);
      writeLabel(context, box, [text], shape, theme);
      break;
    }
  }
}

function boxOf({ x, y }: Place, radius: number): Box {
  return { x: x - radius, y: y - radius, width: 2 * radius, height: 2 * radius };
}
