import { on, onAbort } from "./events.ts";

/** Variables `--rw-...` of the stylesheet, with values for light and dark. */
const NAMES = ["ink", "muted", "line", "area", "reading", "pointer", "touch", "mono"] as const;

/** The colours and fonts of the picture. */
export type Theme = Record<(typeof NAMES)[number] | "background" | "font", string> & { dark: boolean };

const prefersDark = () => matchMedia("(prefers-color-scheme: dark)");

function isDark(): boolean {
  const { body, documentElement: root } = document;
  const jupyter = body.dataset.jpThemeLight;
  if (jupyter) return jupyter === "false";
  // VS Code's and Colab's.
  const theme = body.dataset.vscodeThemeKind || root.getAttribute("theme");
  return theme ? /dark|^vscode-high-contrast$/.test(theme) : prefersDark().matches;
}

/** Sets light or dark on an element and reads the colours that follow. */
export function applyTheme(element: HTMLElement): Theme {
  element.dataset.rwTheme = isDark() ? "dark" : "light";
  const style = getComputedStyle(element);
  const read = NAMES.map((name) => [name, style.getPropertyValue(`--rw-${name}`).trim()]);
  return {
    ...(Object.fromEntries(read) as Record<(typeof NAMES)[number], string>),
    background: style.backgroundColor,
    font: style.fontFamily,
    dark: element.dataset.rwTheme === "dark",
  };
}

/** Calls back when the host switches between light and dark. */
export function watchTheme(callback: () => void, signal: AbortSignal): void {
  const observer = new MutationObserver(callback);
  const attributes = ["data-jp-theme-light", "data-jp-theme-name", "data-vscode-theme-kind", "theme", "class"];
  for (const element of [document.body, document.documentElement]) {
    observer.observe(element, { attributes: true, attributeFilter: attributes });
  }
  onAbort(signal, () => observer.disconnect());
  on(prefersDark(), "change", callback, signal);
}
