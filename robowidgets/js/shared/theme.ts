/** The colours of the picture, as the style sheet gives them for light or dark. */
export interface Theme {
  ink: string;
  muted: string;
  line: string;
  area: string;
  background: string;
  reading: string;
  pointer: string;
  touch: string;
  font: string;
  dark: boolean;
  mono: string;
}

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
  const read = (name: string) => style.getPropertyValue(`--rw-${name}`).trim();
  return {
    ink: read("ink"),
    muted: read("muted"),
    line: read("line"),
    area: read("area"),
    background: style.backgroundColor,
    reading: read("reading"),
    pointer: read("pointer"),
    touch: read("touch"),
    font: style.fontFamily,
    dark: element.dataset.rwTheme === "dark",
    mono: read("mono"),
  };
}

/** Calls back when the host switches between light and dark. */
export function watchTheme(callback: () => void, signal: AbortSignal): void {
  const observer = new MutationObserver(callback);
  const attributes = ["data-jp-theme-light", "data-jp-theme-name", "data-vscode-theme-kind", "theme", "class"];
  for (const element of [document.body, document.documentElement]) {
    observer.observe(element, { attributes: true, attributeFilter: attributes });
  }
  signal.addEventListener("abort", () => observer.disconnect());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", callback, { signal });
}
