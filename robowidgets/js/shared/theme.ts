import { on, onAbort } from "./events.ts";
import { isPrinting, onPrint } from "./print.ts";

/** Variables `--rw-...` of the stylesheet, with values for light and dark. */
const NAMES = [
  "ink",
  "muted",
  "line",
  "guide",
  "ghost",
  "area",
  "seen",
  "reading",
  "pointer",
  "own",
  "touch",
  "mono",
] as const;

/** The colours and fonts of the picture. */
export type Theme = Record<(typeof NAMES)[number] | "background" | "font", string> & { dark: boolean };

const prefersDark = () => matchMedia("(prefers-color-scheme: dark)");
export const forcesColors = () => matchMedia("(forced-colors: active)");

function isDark(): boolean {
  // Paper is white.
  if (isPrinting()) return false;
  // The system's colours apply in any theme of the host, and this query shows if they are dark.
  if (forcesColors().matches) return prefersDark().matches;
  const { body, documentElement: root } = document;
  const jupyter = body.dataset.jpThemeLight;
  if (jupyter) return jupyter === "false";
  // VS Code's, Colab's and marimo's.
  const theme = body.dataset.vscodeThemeKind || root.getAttribute("theme") || body.dataset.theme;
  return theme ? /dark|^vscode-high-contrast$/.test(theme) : prefersDark().matches;
}

function readTheme(element: HTMLElement): Theme {
  const style = getComputedStyle(element);
  const read = NAMES.map((name) => [name, style.getPropertyValue(`--rw-${name}`).trim()]);
  if (forcesColors().matches) for (const pair of read) pair[1] = toHex(element, pair[1] ?? "");
  return {
    ...(Object.fromEntries(read) as Record<(typeof NAMES)[number], string>),
    background: style.backgroundColor,
    font: style.fontFamily,
    dark: element.dataset.rwTheme === "dark",
  };
}

/** A colour of the system, which canvases do not know by its name, as "#rrggbb"; any other text stays as it is. */
function toHex(element: HTMLElement, color: string): string {
  if (!CSS.supports("color", color)) return color;
  const probe = document.createElement("span");
  probe.style.color = color;
  element.append(probe);
  const parts = getComputedStyle(probe).color.match(/[\d.]+/g) ?? [];
  probe.remove();
  return `#${parts
    .slice(0, 3)
    .map((part) => Number(part).toString(16).padStart(2, "0"))
    .join("")}`;
}

/**
 * Sets light or dark on an element, and again when the host switches between them, or the system forces colours; then
 * calls back.
 *
 * @returns a function that gives colours and fonts while drawing: an element outside the page has no computed style
 */
export function followTheme(element: HTMLElement, signal: AbortSignal, callback = () => {}): () => Theme {
  let theme: Theme | null = null;
  const follow = () => {
    element.dataset.rwTheme = isDark() ? "dark" : "light";
    theme = null;
    callback();
  };
  const observer = new MutationObserver(follow);
  const attributes = [
    "data-jp-theme-light",
    "data-jp-theme-name",
    "data-vscode-theme-kind",
    "data-theme",
    "theme",
    "class",
  ];
  for (const host of [document.body, document.documentElement]) {
    observer.observe(host, { attributes: true, attributeFilter: attributes });
  }
  onAbort(signal, () => observer.disconnect());
  onAbort(signal, onPrint("colours", follow));
  for (const query of [prefersDark(), forcesColors()]) on(query, "change", follow, signal);
  follow();
  return () => {
    theme ??= readTheme(element);
    return theme;
  };
}

/** The font of small texts in a picture. */
export function textFont(theme: Theme): string {
  return `11px ${theme.font}`;
}
