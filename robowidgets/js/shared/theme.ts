import { atEnd, on } from "./events.ts";

/** What the style sheet gives as `--rw-` variables, for light or dark. */
const NAMES = ["ink", "muted", "line", "area", "reading", "pointer", "touch", "mono"] as const;

/** The colours and fonts of the picture. */
export type Theme = Record<(typeof NAMES)[number] | "background" | "font", string> & { dark: boolean };

function isDark(): boolean {
  const { body, documentElement: root } = document;
  const jupyter = body.dataset.jpThemeLight;
  if (jupyter) return jupyter === "false";
  const code = body.dataset.vscodeThemeKind;
  if (code) return code.includes("dark") || code === "vscode-high-contrast";
  const colab = root.getAttribute("theme");
  if (colab) return colab === "dark";
  return matchMedia("(prefers-color-scheme: dark)").matches;
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
  atEnd(signal, () => observer.disconnect());
  on(matchMedia("(prefers-color-scheme: dark)"), "change", callback, signal);
}
