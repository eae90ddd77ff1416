import { isPlain, on } from "./events.ts";

/**
 * Keeps plain keys from JupyterLab, which would take them for the notebook: "x" cuts the cell. It asks the focused
 * element, before any parent, when the event passes the document. Saving and running a cell stay its own.
 */
export function keepKeys(root: HTMLElement, signal: AbortSignal): void {
  const keep = (event: KeyboardEvent) => {
    const { activeElement: focused } = document;
    if (!root.contains(focused)) return;
    focused?.toggleAttribute("data-lm-suppress-shortcuts", isPlain(event) && event.key !== "Enter");
  };
  on(window, "keydown", keep, signal, { capture: true });
}
