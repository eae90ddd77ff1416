import type { Box } from "../shared/box.ts";
import { CopyCode } from "../shared/copy.ts";
import { make, makeButton, setHidden, setText } from "../shared/dom.ts";
import { putMarked } from "../shared/popup.ts";
import { type Cloud, countOf } from "./cloud.ts";
import { ABOUT_FORMS, bandWords, countWords, FORMS, type Form, hasCode, toCode } from "./text.ts";
import type { Selection } from "./traits.ts";

/** The selection, in a corner of the picture: the number of points, their bounds, and the code for them. */
export class Chip {
  readonly root = make("div", "rw-floating rw-over rw-cloud-chip");
  readonly copy: CopyCode<Form>;
  readonly #count = make("span", "rw-cloud-count");
  readonly #bands = make("span", "rw-cloud-bands");
  #selection: Selection = {};
  #isBelow = false;

  constructor(onClose: () => void, say: (words: string[]) => void, signal: AbortSignal) {
    this.copy = new CopyCode<Form>((form) => toCode(this.#selection, form), say, signal, FORMS, ABOUT_FORMS);
    const closer = makeButton("rw-close", "Select nothing (Escape)", onClose, signal, "\u00d7");
    const head = make("div", "rw-popup-row");
    head.append(this.#count, closer);
    this.root.append(head, this.#bands, this.copy.row, this.copy.field);
    setHidden(this.root, true);
  }

  /** @param width of the card */
  put(picture: HTMLElement, width: number): void {
    this.#isBelow = putMarked(this.root, picture, width);
  }

  /**
   * @param found 1 for each selected point among the points that the page has; null without a selection, which hides
   * the chip
   * @param whole selected points of the whole cloud; null if unknown
   */
  update(cloud: Cloud | null, selection: Selection, found: Uint8Array | null, whole: number | null): void {
    this.#selection = selection;
    setHidden(this.root, !cloud || !found);
    if (!cloud || !found) return;
    setText(this.#count, countWords(cloud, countOf(found), whole));
    setText(this.#bands, bandWords(selection));
    this.copy.offer((form) => hasCode(selection, form));
  }

  /** In the picture; empty while the chip is hidden or below the picture. */
  get boxes(): Box[] {
    const { offsetLeft: x, offsetTop: y, offsetWidth: width, offsetHeight: height, hidden } = this.root;
    return hidden || this.#isBelow ? [] : [{ x, y, width, height }];
  }
}
