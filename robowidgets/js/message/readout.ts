import { make, set, setHidden, setText } from "../shared/dom.ts";
import { toSaid, toWhole } from "./text.ts";
import type { Field } from "./tree.ts";

/** Digits of a number that is read from a distance. */
const DIGITS = 5;

/** Some fields alone, in large type. */
export class Readout {
  readonly root = make("dl", "rw-message-readout");
  readonly #parts: { box: HTMLElement; name: HTMLElement; value: HTMLElement; unit: HTMLElement; more: HTMLElement }[] =
    [];

  update(fields: readonly Field[], isChanged: (field: Field) => boolean): void {
    const parts = this.#parts;
    while (parts.length < fields.length) {
      const [box, name, line] = [make("div", "rw-message-large"), make("dt", "rw-message-name"), make("dd", "")];
      const value = make("b", "rw-message-value");
      const [unit, more] = [make("span", "rw-message-unit"), make("span", "rw-message-more")];
      line.append(value, unit, more);
      box.append(name, line);
      parts.push({ box, name, value, unit, more });
      this.root.append(box);
    }
    for (const { box } of parts.splice(fields.length)) box.remove();
    for (const [i, field] of fields.entries()) {
      const part = parts[i];
      if (!part) continue;
      const { text, unit, more, isNone } = toSaid(field, DIGITS);
      setText(part.name, field.path);
      setText(part.value, text);
      setText(part.unit, unit);
      setText(part.more, more);
      setHidden(part.more, !more);
      set(part.box, "title", toWhole(field));
      part.value.classList.toggle("rw-message-word", field.node.kind === "text" || more !== "");
      part.value.classList.toggle("rw-message-none", isNone);
      part.box.classList.toggle("rw-message-changed", isChanged(field));
      if (field.node.kind === "flag") set(part.value.dataset, "rwFlag", String(field.value));
      else delete part.value.dataset.rwFlag;
    }
  }
}
