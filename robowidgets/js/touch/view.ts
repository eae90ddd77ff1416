import type { Box } from "../shared/box.ts";
import { make, setHidden, setText } from "../shared/dom.ts";
import { onAbort } from "../shared/events.ts";
import type { Sensor, Touch } from "../shared/frames/touch.ts";
import { type Model, onChange } from "../shared/model.ts";
import { setHeld } from "../shared/room.ts";
import { SampleCard } from "../shared/sample_card.ts";
import type { Stream } from "../shared/stream.ts";
import type { About } from "../shared/traits.ts";
import { LEAST_WIDTH, layAround } from "./around.ts";
import { Body } from "./body.ts";
import type { Clock } from "./clock.ts";
import { Footer } from "./footer.ts";
import { GAP, layRows } from "./rows.ts";
import { select } from "./select.ts";
import { modeWord, toLabels, toShared } from "./text.ts";
import { Tile } from "./tile.ts";
import type { TouchTraits } from "./traits.ts";

interface TouchAbout extends About {
  dialect?: string;
  mode?: string;
  /** True if time stands still, as in a recording that is not live. */
  still?: boolean;
}

const TICK_MS = 100;
const PADDING = 12;
/** Numbers of rectangles from which a card gets more room on the screen of a recording or a feed. */
const MANY = [3, 4, 5, 7, 9];

/** One view of a touch widget: a rectangle for each sensor, in rows or round the robot's body. */
export class TouchView {
  readonly #model: Model<TouchTraits>;
  readonly #stream: Stream<Touch>;
  readonly #clock: Clock;
  readonly #card: SampleCard;
  readonly #footer: Footer;
  readonly #field = make("div", "rw-field");
  readonly #empty = make("div", "rw-empty");
  readonly #body = new Body();
  readonly #tiles = new Map<string, Tile>();
  #count = 0;
  #tick: ReturnType<typeof setTimeout> | undefined;
  /** Size of the picture at which `#isLow` was read. */
  #sized = "";
  /** True if rectangles have to fit into the picture, by the stylesheet. */
  #isLow = false;

  constructor(
    model: Model<TouchTraits>,
    element: HTMLElement,
    stream: Stream<Touch>,
    clock: Clock,
    signal: AbortSignal,
  ) {
    this.#model = model;
    this.#stream = stream;
    this.#clock = clock;
    this.#card = new SampleCard(element, "touch", model, stream, () => this.#draw(), signal);
    this.#footer = new Footer(this.#card.footer);
    this.#field.role = "list";
    this.#card.picture.append(this.#field, this.#empty);
    onChange(model, ["sensors", "labels", "angles"], this.#card.redraw, signal);
    onAbort(signal, () => clearTimeout(this.#tick));
  }

  #draw(): void {
    const touch = this.#stream.shown;
    const all = touch?.sensors ?? [];
    const sensors = select(all, this.#model.get("sensors"));
    const { dialect = "", mode, still = false } = this.#stream.about as TouchAbout;
    const names = sensors.map(({ name }) => name);
    const labels = toLabels(names, this.#model.get("labels"));
    this.#card.update([dialect, modeWord(mode)], "states", mode !== "event");
    this.#footer.update(sensors, all, toShared(names, labels));
    setHidden(this.#empty, sensors.length > 0);
    setText(this.#empty, this.#card.waiting("touch message"));
    this.#lay(sensors);
    this.#say(sensors, labels, still ? 0 : this.#clock.elapsed, this.#clock.runs && !still);
  }

  /** Height for rectangles if they have to fit into the picture; else the picture is as high as they are. */
  get #room(): number {
    const { width, height } = this.#card.size;
    const sized = `${width} ${height}`;
    if (sized !== this.#sized) {
      this.#sized = sized;
      this.#isLow = getComputedStyle(this.#card.picture).getPropertyValue("--rw-is-low") !== "";
    }
    return this.#isLow ? height - 2 * this.#padding - this.#card.noticeHeight : Infinity;
  }

  get #padding(): number {
    return this.#isLow ? PADDING / 2 : PADDING;
  }

  /** Puts every rectangle in its place. */
  #lay(sensors: Sensor[]): void {
    const width = this.#card.size.width - 2 * PADDING;
    const given = this.#model.get("angles");
    const names = sensors.map(({ name }) => name);
    const placed = new Map(names.flatMap((name) => (typeof given[name] === "number" ? [[name, given[name]]] : [])));
    const around = placed.size && width >= LEAST_WIDTH ? layAround(placed, width) : null;
    if (around) this.#body.draw(around, width, sensors);
    const below = around ? around.height + 2 * GAP : 0;
    const rows = layRows(
      names.filter((name) => !around?.boxes.has(name)),
      width,
      below,
      this.#room,
    );
    this.#card.picture.style.paddingTop = `${this.#padding + this.#card.noticeHeight}px`;
    this.#field.style.height = `${rows.boxes.size ? rows.bottom : (around?.height ?? 0)}px`;
    this.#putTiles(names, new Map([...(around?.boxes ?? []), ...rows.boxes]));
    if (!around) this.#body.element.remove();
    else if (this.#field.firstChild !== this.#body.element) this.#field.prepend(this.#body.element);
    this.#tellCount();
  }

  /** Sets attributes of the boxes around to the number of sensors. */
  #tellCount(): void {
    const { length } = this.#field.children;
    if (length === this.#count) return;
    this.#count = length;
    for (const many of MANY) setHeld(this.#card.root, `tiles-${many}`, length >= many);
  }

  #putTiles(names: string[], boxes: Map<string, Box>): void {
    for (const [name, tile] of this.#tiles) {
      if (boxes.has(name)) continue;
      tile.element.remove();
      this.#tiles.delete(name);
    }
    names.forEach((name, i) => {
      const tile = this.#tiles.get(name) ?? new Tile();
      this.#tiles.set(name, tile);
      const box = boxes.get(name);
      if (box) tile.place(box);
      // Screen readers follow the order of elements: keep the order of the sensors.
      const tiles = this.#field.querySelectorAll(":scope > .rw-tile");
      if (tiles[i] !== tile.element) this.#field.insertBefore(tile.element, tiles[i] ?? null);
    });
  }

  /** Writes the facts about each sensor, and again while a touch lasts. */
  #say(sensors: Sensor[], labels: string[], elapsed: number | null, runs: boolean): void {
    clearTimeout(this.#tick);
    sensors.forEach((sensor, i) => {
      this.#tiles.get(sensor.name)?.update(sensor, labels[i] ?? sensor.name, elapsed);
    });
    const lasting = runs && sensors.some(({ state }) => state === "touched");
    if (lasting) this.#tick = setTimeout(this.#card.redraw, TICK_MS);
  }
}
