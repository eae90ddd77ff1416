import { make, makeButton, setText } from "../shared/dom.ts";
import { on } from "../shared/events.ts";
import { FORMS, type Form } from "./code.ts";

const COPIED_MS = 2000;
const LABEL = "Copy code";

/**
 * A button that copies code in the form that stands beside it. Where the browser does not allow that, a field shows the
 * code, to be copied by hand.
 */
export class CopyCode {
  /** The button and the form. */
  readonly row = make("div", "rw-chip-row rw-chip-actions");
  /** Hidden as long as it is not needed. */
  readonly field = make("textarea", "rw-code");
  readonly #button: HTMLButtonElement;
  readonly #form = make("select", "rw-button rw-chip-form");
  readonly #toCode: (form: Form) => string;
  readonly #say: (words: string[]) => void;
  #copied: ReturnType<typeof setTimeout> | undefined;

  /** @param say has a screen reader say words */
  constructor(toCode: (form: Form) => string, say: (words: string[]) => void, signal: AbortSignal) {
    this.#toCode = toCode;
    this.#say = say;
    this.#button = makeButton("rw-copy", `${LABEL} (C)`, () => this.copy(), signal, LABEL);
    // Its name is the text, which says when it is copied.
    this.#button.ariaLabel = null;
    for (const form of FORMS) this.#form.append(new Option(form));
    this.#form.title = "for a Scan of robowidgets, for a ROS message without it, or the plain slice";
    this.#form.ariaLabel = "form of the code";
    this.row.append(this.#button, this.#form);
    // Their keys are theirs: the picture would walk its rays.
    for (const own of [this.#form, this.field]) {
      on(own, "keydown", (event) => event.key !== "Escape" && event.stopPropagation(), signal);
    }
    this.field.readOnly = true;
    this.field.hidden = true;
    this.field.ariaLabel = "code to copy";
  }

  async copy(): Promise<void> {
    const code = this.#toCode(this.#form.value as Form);
    const isCopied = await copyText(code);
    clearTimeout(this.#copied);
    this.field.hidden = isCopied;
    this.#say([isCopied ? "copied" : "press Ctrl and C to copy"]);
    if (isCopied) {
      setText(this.#button, "Copied");
      this.#copied = setTimeout(() => this.reset(), COPIED_MS);
    } else {
      this.field.value = code;
      this.field.focus({ preventScroll: true });
      this.field.select();
    }
  }

  /** As before a click. */
  reset(): void {
    clearTimeout(this.#copied);
    setText(this.#button, LABEL);
    this.field.hidden = true;
  }
}

/** Copies text; resolves to whether the browser allowed it. */
async function copyText(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return copyByCommand(text);
  }
}

/** The way of pages that are not served securely, which have no clipboard. */
function copyByCommand(text: string): boolean {
  let isCopied = false;
  const onCopy = (event: ClipboardEvent) => {
    event.clipboardData?.setData("text/plain", text);
    event.preventDefault();
    isCopied = event.clipboardData !== null;
  };
  document.addEventListener("copy", onCopy);
  document.execCommand("copy");
  document.removeEventListener("copy", onCopy);
  return isCopied;
}
