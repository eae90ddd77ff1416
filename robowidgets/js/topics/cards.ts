/** The cards of the view that contains the list, by their titles. */
export class Cards {
  readonly #list: HTMLElement;
  #lit: HTMLElement[] = [];

  constructor(list: HTMLElement) {
    this.#list = list;
  }

  /** Outlines cards of these titles, and no others. */
  light(titles: string[]): void {
    for (const card of this.#lit) card.classList.remove("rw-pointed-at");
    this.#lit = this.#named(titles);
    for (const card of this.#lit) card.classList.add("rw-pointed-at");
  }

  /** Brings the first card of these titles into view, and gives it the focus. */
  show(titles: string[]): void {
    const [card] = this.#named(titles);
    card?.scrollIntoView({ block: "nearest" });
    card?.querySelector<HTMLElement>("[tabindex='0']")?.focus({ preventScroll: true });
  }

  #named(titles: string[]): HTMLElement[] {
    // The list is in an element of its host, which is in the element of the view.
    const view = titles.length ? this.#list.parentElement?.parentElement : null;
    const cards = [...(view?.querySelectorAll<HTMLElement>(".rw-card") ?? [])];
    return cards.filter((card) => titles.includes(card.querySelector(".rw-title")?.textContent ?? ""));
  }
}
