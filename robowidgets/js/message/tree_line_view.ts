import { make, set, setHidden, setText } from "../shared/dom.ts";
import { toSaid } from "./text.ts";
import type { TreeLine } from "./tree_lines.ts";

/** The elements of a line of the tree. */
export class TreeLineView {
  readonly root = make("div", "rw-message-row");
  readonly #fold = make("span", "rw-message-fold");
  readonly #name = make("span", "rw-message-name");
  readonly #derived = make("span", "rw-message-derived");
  readonly #gap = make("span", "rw-message-gap");
  readonly #more = make("span", "rw-message-more");
  readonly #value = make("span", "rw-message-value");
  readonly #unit = make("span", "rw-message-unit");

  constructor() {
    this.root.role = "treeitem";
    this.root.tabIndex = -1;
    this.root.append(this.#fold, this.#name, this.#derived, this.#gap, this.#more, this.#value, this.#unit);
  }

  /** The place for the buttons of the line. */
  get gap(): HTMLElement {
    return this.#gap;
  }

  update(line: TreeLine, isChanged: boolean): void {
    const { field, depth, isOpen, label, derived, asks } = line;
    const { root } = this;
    if (root.dataset.rwRow !== line.key) root.dataset.rwRow = line.key;
    const level = String(depth + 1);
    if (root.ariaLevel !== level) {
      root.ariaLevel = level;
      root.style.setProperty("--rw-depth", String(depth));
    }
    const expanded = isOpen === null ? null : String(isOpen);
    if (root.ariaExpanded !== expanded) root.ariaExpanded = expanded;
    setText(this.#fold, isOpen === null ? "" : isOpen ? "\u25be" : "\u25b8");
    const name = field?.node.name ?? label;
    setText(this.#name, name);
    if (this.#name.title !== name) this.#name.title = name;
    setText(this.#derived, derived && "worked out");
    setHidden(this.#derived, !derived);
    root.classList.toggle("rw-message-changed", isChanged);
    root.classList.toggle("rw-message-asks", asks !== "" || (!field && !derived && isOpen === null));
    const said = field ? toSaid(field) : { text: derived, unit: "", more: "", isNone: false };
    const isParent = isOpen !== null;
    setText(this.#value, said.text);
    this.#value.classList.toggle("rw-message-none", said.isNone);
    this.#value.classList.toggle("rw-message-sum", isParent || derived !== "");
    if (field?.node.kind === "flag") set(this.#value.dataset, "rwFlag", String(field.value));
    else delete this.#value.dataset.rwFlag;
    setText(this.#more, said.more);
    setText(this.#unit, said.unit);
  }
}
