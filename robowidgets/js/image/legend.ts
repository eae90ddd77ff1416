import { make, makeButton, set, setHidden, setText } from "../shared/dom.ts";
import { toMetres } from "../shared/format.ts";
import { type Scale, scaleColors } from "./colors.ts";
import { toValue } from "./text.ts";

/** The color scale: the numbers at its ends, and the share of the picture without a value. */
export class Legend {
  readonly root = make("span", "rw-image-legend");
  readonly #low = make("b", "");
  readonly #high = make("b", "");
  readonly #bar = make("span", "rw-image-bar");
  readonly #nothing = make("span", "");
  readonly #keep: HTMLButtonElement;

  constructor(onKeep: () => void, signal: AbortSignal) {
    this.#keep = makeButton("rw-image-keep", "Keep the scale, or fit it to each picture (s)", onKeep, signal, "Keep");
    this.#keep.ariaLabel = null;
    this.root.append(this.#low, this.#bar, this.#high, this.#keep, this.#nothing);
  }

  /** @param scale null if the picture has no numbers that are shown as colors */
  update(scale: Scale | null, isKept: boolean, isDepth: boolean, nothing: number, dark: boolean): void {
    setHidden(this.root, scale === null);
    if (!scale) return;
    const [low, high] = scale;
    setText(this.#low, isDepth ? toMetres(low, high) : toValue(low));
    setText(this.#high, isDepth ? toMetres(high, high) : toValue(high));
    const colors = scaleColors(isDepth, dark);
    const background = `linear-gradient(to right, ${(isDepth ? colors : [colors[0], colors.at(-1)]).join(",")})`;
    set(this.#bar.style, "background", background);
    set(this.#keep, "ariaPressed", String(isKept));
    setText(this.#nothing, nothing > 0 ? `${toShare(nothing)} nothing` : "");
  }
}

/** A share in per cent; 0 and 100 only for none and all. */
function toShare(share: number): string {
  if (share < 0.01) return "< 1 %";
  return `${share < 1 ? Math.min(99, Math.round(100 * share)) : 100} %`;
}
