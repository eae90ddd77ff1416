import { on, onAbort } from "./events.ts";
import { isPrinting, onPrint } from "./print.ts";
import type { Look } from "./traits.ts";

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

/** The part of a model with the look that the user chose. */
interface Themed {
  get(name: "theme"): Look;
  on(event: "change:theme", callback: () => void): void;
  off(event: "change:theme", callback: () => void): void;
}

/** The colours and fonts of the picture. */
export type Theme = Record<(typeof NAMES)[number] | "background" | "font", string> & { dark: boolean };

const prefersDark = () => matchMedia("(prefers-color-scheme: dark)");
export const forcesColors = () => matchMedia("(forced-colors: active)");

/** The event of the document after which each look is read again, because a screen's may have changed. */
const CHANGED = "rw-look";

/** The look of an element: the look that the user chose for the screen around it, or else its own. */
function lookOf(element: HTMLElement, own: Look): Look {
  const outer = element.parentElement?.closest<HTMLElement>("[data-rw-look]")?.dataset.rwLook as Look | undefined;
  return outer && outer !== "auto" ? outer : own;
}

function isDark(look: Look): boolean {
  // Paper is white.
  if (isPrinting()) return false;
  // The system's colours apply in any theme of the host, and this query shows if they are dark.
  if (forcesColors().matches) return prefersDark().matches;
  if (look === "dark" || look === "light" || look === "paper") return look === "dark";
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
 * Sets light or dark, and the look that the user chose, on an element; again when the host switches between light and
 * dark, the system forces colours, or the user chooses another look. Then calls back.
 *
 * @param model whose `theme` is the look of the element
 * @returns a function that gives colours and fonts while drawing: an element outside the page has no computed style
 */
export function followTheme(
  element: HTMLElement,
  model: Themed,
  signal: AbortSignal,
  callback = () => {},
): () => Theme {
  let theme: Theme | null = null;
  const follow = () => {
    const look = lookOf(element, model.get("theme"));
    element.dataset.rwLook = look;
    element.dataset.rwTheme = isDark(look) ? "dark" : "light";
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
  const tell = () => void document.dispatchEvent(new Event(CHANGED));
  model.on("change:theme", tell);
  onAbort(signal, () => model.off("change:theme", tell));
  on(document, CHANGED, follow, signal);
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
