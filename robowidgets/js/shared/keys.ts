import { isPlain, on } from "./events.ts";
import { isUndo } from "./undo.ts";

const isField = (element: Element | null) => element instanceof HTMLInputElement;

/**
 * Keeps plain keys from JupyterLab, whose shortcuts would act on the notebook: "x" cuts the cell. JupyterLab reads this
 * attribute of the focused element when the event reaches the document. Shortcuts for saving and running still work.
 */
export function keepKeys(root: HTMLElement, signal: AbortSignal): void {
  const keep = (event: KeyboardEvent) => {
    const { activeElement: focused } = document;
    if (!root.contains(focused)) return;
    const isPlainKey = isPlain(event) && (event.key !== "Enter" || isField(focused) || focused?.matches(".rw-grip"));
    focused?.toggleAttribute("data-lm-suppress-shortcuts", Boolean(isPlainKey || isUndo(event)));
  };
  on(window, "keydown", keep, signal, { capture: true });
}
