/** Returns the address of the moment that the widgets around an element show; empty if the page has none for it. */
type ToLink = (element: Element) => string;

/** The key under which a page without a kernel leaves its function: each widget may have a script of its own. */
const KEY = Symbol.for("robowidgets link");
const page = globalThis as { [KEY]?: ToLink };

/** Offers links to moments in this page. Call it before any widget is rendered. */
export function offerLinks(toLink: ToLink): void {
  page[KEY] = toLink;
}

export function hasLinks(): boolean {
  return page[KEY] !== undefined;
}

export function linkFor(element: Element): string {
  return page[KEY]?.(element) ?? "";
}
