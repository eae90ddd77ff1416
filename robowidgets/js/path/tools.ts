import { make, makeButton, setHidden } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import type { Place } from "../shared/floor.ts";

/** Actions of the user on the map. */
export interface MapActs {
  onFollow(): void;
  onMeasure(): void;
  onLayers(): void;
  onFit(): void;
  onZoom(direction: -1 | 1): void;
  onFrame(frame: string): void;
}

/** The buttons of a map, which stand before the one that freezes. */
export class Tools {
  readonly frame = make("select", "rw-button rw-map-frame");
  readonly follow: HTMLButtonElement;
  readonly measure: HTMLButtonElement;
  readonly layers: HTMLButtonElement;
  readonly fit: HTMLButtonElement;
  readonly all: HTMLElement[];
  #frames = "";

  constructor(acts: MapActs, signal: AbortSignal) {
    this.frame.ariaLabel = "Frame of the map";
    this.frame.title = "The frame in which the map is drawn";
    on(this.frame, "change" as "input", () => acts.onFrame(this.frame.value), signal);
    this.follow = makeButton(
      "rw-map-wide",
      "Keep the robot in the middle (f)",
      () => acts.onFollow(),
      signal,
      "Follow",
    );
    this.measure = makeButton(
      "rw-map-wide",
      "Measure by two clicks, or a drag (m)",
      () => acts.onMeasure(),
      signal,
      "Measure",
    );
    this.layers = makeButton("", "List of the layers (l)", () => acts.onLayers(), signal, "Layers");
    const farther = makeButton("rw-zoom rw-map-wide", "Zoom out (\u2212)", () => acts.onZoom(1), signal, "\u2212");
    const closer = makeButton("rw-zoom rw-map-wide", "Zoom in (+)", () => acts.onZoom(-1), signal, "+");
    this.fit = makeButton("", "Show all of it (0)", () => acts.onFit(), signal, "Fit");
    this.all = [this.frame, this.follow, this.measure, this.layers, farther, closer, this.fit];
  }

  /** Shows the frames in which the map may be drawn, and the one in which it is. */
  updateFrames(frames: readonly string[], shown: string): void {
    const names = shown && !frames.includes(shown) ? [shown, ...frames] : [...frames];
    setHidden(this.frame, names.length < 2);
    const key = names.join("\n");
    if (key !== this.#frames) {
      this.#frames = key;
      const options = names.map((name) => {
        const option = make("option", "", `Frame ${name}`);
        option.value = name;
        return option;
      });
      this.frame.replaceChildren(...options);
    }
    if (document.activeElement !== this.frame || !this.frame.value) this.frame.value = shown;
  }
}

/** A line that the user measures. */
export interface Measured {
  from: Place;
  to: Place | null;
}
