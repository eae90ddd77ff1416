import type { Box } from "../shared/box.ts";
import { Chip, type ChipTexts } from "./chip.ts";
import { placeChip } from "./chip_place.ts";
import { type Form, toCode } from "./code.ts";
import type { Host, Stage } from "./layer.ts";
import { shownBy } from "./mount.ts";
import type { Sector } from "./sector.ts";
import type { SectorNumbers } from "./sector_numbers.ts";
import type { Named, SectorStore } from "./sector_store.ts";
import { describeSector, sayOf, sectorOfText } from "./sector_words.ts";

const AHEAD: Sector = { start: 0, end: 0 };

/** The owner of the chip: the layer of sectors. */
interface Owner {
  say(): void;
  remove(): void;
  deselect(): void;
}

/**
 * The chip of the picked sector, in a free corner of the picture or below it. It also shows while the user types the
 * rays of a new sector.
 */
export class SectorChip {
  /** Its place in the picture; null while it is elsewhere or hidden. */
  box: Box | null = null;
  readonly #host: Host;
  readonly #store: SectorStore;
  readonly #numbers: SectorNumbers;
  readonly #owner: Owner;
  readonly #tell = () => {
    if (this.#key) this.#show();
  };
  readonly #chip: Chip;
  /** The sector that was picked when the field for other rays opened; null while the field is closed. */
  #asked: string | null = null;
  /** True after it has found no room in the picture; it then stays below. */
  #isBelow = false;
  #key = "";

  constructor(host: Host, store: SectorStore, numbers: SectorNumbers, owner: Owner) {
    this.#host = host;
    this.#store = store;
    this.#numbers = numbers;
    this.#owner = owner;
    this.#chip = this.#make();
  }

  place(stage: Stage): void {
    const before = this.box;
    this.box = this.#placeBox(stage, before);
    // The line to it, and the labels that give way to it, were drawn before its place was known.
    if (before?.x !== this.box?.x || before?.y !== this.box?.y) this.#host.card.redraw();
  }

  #placeBox(stage: Stage, before: Box | null): Box | null {
    const { picked } = this.#store;
    if (this.#asked !== this.#pickedKey) this.#asked = null;
    const isAsking = this.#asked !== null;
    if (!(picked || isAsking) || !stage.scan) {
      this.#chip.hide();
      this.#isBelow = false;
      this.#key = "";
      return null;
    }
    const box = this.#isBelow ? null : placeChip(this.#chip.size, stage, picked?.sector ?? AHEAD, before);
    // It does not return to the picture while it shows: the picture may have become lower, and would jump.
    this.#isBelow = !box;
    const key = JSON.stringify([picked, isAsking, this.#isBelow]);
    // Its numbers follow a drag at once, and a live scan at reading speed.
    if (key === this.#key) this.#host.card.texts.ask(this.#tell);
    else this.#show();
    this.#key = key;
    if (!box) return null;
    this.#chip.place(box);
    stage.covered.push(box);
    return box;
  }

  /** Identifies the picked sector, even if the angles of a kept one change. */
  get #pickedKey(): string {
    const { picked } = this.#store;
    return picked ? picked.name || JSON.stringify(picked.sector) : "";
  }

  /** Asks for the rays of a new sector. */
  askRays(): void {
    this.#asked = this.#pickedKey;
    this.#host.card.drawNow();
    this.#chip.askRays();
  }

  /** Closes the field for a new sector; returns true if it was open. */
  close(): boolean {
    const wasAsking = this.#asked !== null;
    this.#asked = null;
    this.#host.card.redraw();
    return wasAsking;
  }

  askName(proposal: string): void {
    this.#chip.askName(proposal);
  }

  copy(): void {
    this.#chip.copy();
  }

  /** The text of the picked sector for a screen reader. */
  get words(): string[] {
    const texts = this.#texts;
    return texts ? sayOf(texts) : [];
  }

  get #texts(): ChipTexts | null {
    const { picked } = this.#store;
    const scan = this.#host.stream.shown;
    return picked && scan ? this.#describe(picked, scan) : null;
  }

  #describe(picked: Named, scan: NonNullable<Stage["scan"]>): ChipTexts {
    const { stretches, measured } = this.#numbers.look(scan, picked.sector);
    const state = this.#numbers.stateOf(picked.name);
    const { viewRange } = this.#host.stage.projection;
    const { model, stream } = this.#host;
    return describeSector(
      picked,
      scan,
      stretches,
      measured,
      state,
      viewRange,
      model.get("angle_unit"),
      shownBy(model, stream.about),
    );
  }

  #show(): void {
    this.#chip.show(this.#asked === null ? this.#texts : null, this.#isBelow);
  }

  #make(): Chip {
    const { card, model, signal, stream } = this.#host;
    const actions = {
      toCode: (form: Form) => {
        const { picked } = this.#store;
        const { sweep } = this.#host.stage;
        return picked ? toCode(picked.sector, form, sweep, model.get("angle_offset"), stream.about.mount) : "";
      },
      say: (words: string[]) => card.say(words),
      onName: (name: string) => {
        const error = this.#store.keep(name);
        if (!error) this.#owner.say();
        return error;
      },
      onRemove: () => this.#owner.remove(),
      onClose: () => this.#owner.deselect(),
      onType: (text: string) => this.#type(text),
    };
    return new Chip(card.picture, actions, card.redraw, signal);
  }

  /**
   * Selects the rays that a text names: as the picked sector, or as a new one if the field for other rays is open.
   * Returns an error text, or "".
   */
  #type(text: string): string {
    const scan = this.#host.stream.shown;
    const { picked } = this.#store;
    if (!scan) return "";
    const found = sectorOfText(scan, text);
    if (typeof found === "string") return found;
    const { now } = this.#store;
    if (picked && this.#asked === null) this.#store.put({ ...picked, sector: { ...picked.sector, ...found } });
    else this.#store.put({ name: "", sector: found });
    this.#store.keepUndo(now);
    this.#asked = null;
    this.#owner.say();
    return "";
  }
}
