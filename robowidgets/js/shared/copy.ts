import { make, makeButton, set, setHidden, setText } from "./dom.ts";
import { on } from "./events.ts";
import { hasLinks, linkFor } from "./link.ts";

const COPIED_MS = 2000;
const LABEL = "Copy code";
const LINK_LABEL = "Copy link";

/**
 * A button that copies code, in the form that is chosen next to it if there are several. In a page without a kernel,
 * another button copies a link to the moment. If the browser does not allow to copy, a field shows the text, to be
 * copied by hand.
 */
export class CopyCode<F extends string = string> {
  /** The button and the form. */
  readonly row = make("div", "rw-chip-row rw-chip-actions");
  /** Hidden as long as it is not needed. */
  readonly field = make("textarea", "rw-code");
  readonly #button: HTMLButtonElement;
  readonly #form = make("select", "rw-button rw-chip-form");
  readonly #toCode: (form: F) => string;
  readonly #say: (words: string[]) => void;
  #copied: ReturnType<typeof setTimeout> | undefined;

  /**
   * @param say announces words to a screen reader
   * @param forms the forms of the code, if there are several
   * @param about the tooltip of the forms
   */
  constructor(
    toCode: (form: F) => string,
    say: (words: string[]) => void,
    signal: AbortSignal,
    forms: readonly F[] = [],
    about = "",
  ) {
    this.#toCode = toCode;
    this.#say = say;
    this.#button = makeButton("rw-copy", `${LABEL} (C)`, () => this.copy(), signal, LABEL);
    // Its accessible name is the text, which changes after copying.
    this.#button.ariaLabel = null;
    for (const form of forms) this.#form.append(new Option(form));
    this.#form.title = about;
    this.#form.ariaLabel = "form of the code";
    this.row.append(this.#button, ...(forms.length ? [this.#form] : []));
    if (hasLinks()) {
      const onLink = () => this.#copyText(link, linkFor(this.row));
      const link = makeButton("rw-copy-link", "Copy a link to this moment", onLink, signal, LINK_LABEL);
      link.ariaLabel = null;
      this.row.append(link);
    }
    // Their keys must not reach the picture, which would walk its rays.
    for (const own of [this.#form, this.field]) {
      on(own, "keydown", (event) => event.key !== "Escape" && event.stopPropagation(), signal);
    }
    this.field.readOnly = true;
    this.field.hidden = true;
    this.field.ariaLabel = "code to copy";
  }

  /** Offers only the forms that have code now; chooses the first of them if the chosen one has none. */
  offer(has: (form: F) => boolean): void {
    for (const option of this.#form.options) set(option, "disabled", !has(option.value as F));
    if (this.#form.selectedOptions[0]?.disabled) this.#form.selectedIndex = 0;
  }

  async copy(): Promise<void> {
    await this.#copyText(this.#button, this.#toCode(this.#form.value as F));
  }

  async #copyText(button: HTMLButtonElement, text: string): Promise<void> {
    const isCopied = await copyText(text);
    this.reset();
    setHidden(this.field, isCopied);
    this.#say([isCopied ? "copied" : "press Ctrl and C to copy"]);
    if (isCopied) {
      setText(button, "Copied");
      this.#copied = setTimeout(() => this.reset(), COPIED_MS);
    } else {
      this.field.value = text;
      this.field.focus({ preventScroll: true });
      this.field.select();
    }
  }

  /** Restores the state before a click. */
  reset(): void {
    clearTimeout(this.#copied);
    setText(this.#button, LABEL);
    const link = this.row.querySelector<HTMLElement>(".rw-copy-link");
    if (link) setText(link, LINK_LABEL);
    this.field.hidden = true;
  }
}

/** Copies text; resolves to true if the browser allowed it. */
export async function copyText(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return copyByCommand(text);
  }
}

/** Copies text in a page that is not served securely, which has no clipboard. */
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
