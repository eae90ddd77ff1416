import { isPlain } from "../shared/events.ts";
import type { SectorLayer } from "./sector_layer.ts";

const ARROWS: Record<string, number> = {
  ArrowRight: 1,
  ArrowUp: 1,
  ArrowLeft: -1,
  ArrowDown: -1,
  PageUp: 10,
  PageDown: -10,
};

/** Handles a key for sectors; returns true if it has an effect. */
export function onSectorKey(event: KeyboardEvent, layer: SectorLayer): boolean {
  const { key, shiftKey, target } = event;
  const onPicture = target instanceof HTMLElement && target.classList.contains("rw-picture");
  if (key === "[" || key === "]") {
    // "[" is the edge with the smaller index for most scanners: the right one, where the sector starts.
    layer.chooseEdge(key === "[" ? "start" : "end");
    return true;
  }
  const arrow = ARROWS[key];
  if (layer.edge && arrow) {
    layer.moveEdge(shiftKey ? 10 * arrow : arrow);
    return true;
  }
  if (key === "Escape") return layer.escape();
  if (!isPlain(event)) return false;
  if (key === "t") layer.askRays();
  else if (!layer.store.picked) return false;
  else if (key === "Enter" && onPicture) layer.keep();
  else if (key === "Delete" || key === "Backspace") layer.remove();
  else if (key === "c") layer.copy();
  else return false;
  return true;
}
