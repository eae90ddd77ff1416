import { make, makeButton, makeIcon, set, setHidden, setText } from "../dom.ts";
import { isPlain, on } from "../events.ts";
import { keepKeys } from "../keys.ts";
import type { StopControl } from "./control.ts";

/** A square in an octagon. */
const SIGN = "M3.5 0h5L12 3.5v5L8.5 12h-5L0 8.5v-5z M4 1.2L1.2 4v4L4 10.8h4L10.8 8v-4L8 1.2z M3.8 3.8h4.4v4.4h-4.4z";

/** Stop, and a second button that allows driving again, so that a double press does not do both. */
export class StopButtons {
  readonly stop: HTMLButtonElement;
  readonly allow: HTMLButtonElement;
  readonly #word = make("span", "rw-stop-word");
  readonly #control: StopControl;

  /** @param root the view; Escape stops from anywhere in it, and in the box around it */
  constructor(root: HTMLElement, control: StopControl, signal: AbortSignal) {
    this.#control = control;
    keepKeys(root, signal);
    const press = () => control.stop();
    this.stop = makeButton("rw-stop", "Stop the robot (Escape in its view), and let nobody drive", () => {}, signal);
    this.stop.append(makeIcon(SIGN), this.#word);
    const onAllow = () => control.allow();
    this.allow = makeButton("rw-allow", "Let programs and hands drive again", onAllow, signal, "Allow driving");
    // Stop on press, not on release. A click without a pointer comes from a screen reader.
    on(this.stop, "pointerdown", ({ button }) => button === 0 && press(), signal);
    on(this.stop, "click", ({ detail }) => detail === 0 && press(), signal);
    const onKey = (event: KeyboardEvent) => {
      if (!isPlain(event)) return;
      if (event.key === "Escape" && (root.closest(".rw-one-screen, .widget-vbox") ?? root).matches(":focus-within"))
        press();
      // The document does not know the focused element within a shadow root.
      const focused = [this.stop, this.allow].find((button) => button.matches(":focus"));
      // JupyterLab would edit the cell.
      if (event.key === "Enter") focused?.toggleAttribute("data-lm-suppress-shortcuts", true);
      if (focused !== this.stop || !["Enter", " "].includes(event.key)) return;
      event.preventDefault();
      press();
    };
    on(window, "keydown", onKey, signal, { capture: true });
  }

  /** Updates the buttons; Allow is shown only while stop is latched. */
  update(): void {
    const { stopped } = this.#control.told;
    const isDown = stopped || ["asking", "interrupted"].includes(this.#control.note);
    setText(this.#word, stopped ? "Stopped" : "Stop");
    set(this.stop, "ariaPressed", String(isDown));
    setHidden(this.allow, !stopped);
  }
}
