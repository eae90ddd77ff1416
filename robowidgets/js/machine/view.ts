import { make, setHidden, setText } from "../shared/dom.ts";
import { onAbort } from "../shared/events.ts";
import { toFixed } from "../shared/format.ts";
import { lacksKernel, type Model, onChange, onMessage } from "../shared/model.ts";
import { SampleCard } from "../shared/sample_card.ts";
import { throttle } from "../shared/schedule.ts";
import type { Stream } from "../shared/stream.ts";
import { MachineBand } from "./band.ts";
import { Entries } from "./entries.ts";
import { place } from "./layout.ts";
import type { Outlines } from "./outlines.ts";
import { Picture } from "./picture.ts";
import { activeText, isActive, type Step } from "./step.ts";
import type { MachineAbout, MachineOutline, MachineTraits, StateOutline } from "./traits.ts";

const PADDING = 12;
/** Width of the list of moves if there is room for it next to the picture. */
const LIST_WIDTH = 236;
/** Least scale of a picture that shrinks: to fit, to show machines that would be folded, and to keep its height. */
const SMALLEST = 0.5;
const UNFOLDED = 0.75;
const KEPT = 0.65;
const SAY_MS = 1000;
const REFUSAL = "this moment is not kept here";
const REFUSAL_MS = 4000;

/** One view of a machine: its picture, and the moves that were made. */
export class MachineView {
  readonly #model: Model<MachineTraits>;
  readonly #stream: Stream<Step>;
  readonly #outlines: Outlines;
  readonly #card: SampleCard;
  readonly #picture = new Picture((path) => this.#go(path));
  readonly #entries: Entries;
  readonly #band: MachineBand;
  readonly #empty = make("div", "rw-empty");
  readonly #time = make("b", "");
  readonly #rate = make("span", "");
  readonly #refusal = make("b", "");
  readonly #text = make("canvas", "").getContext("2d");
  readonly #sayActive: () => void;
  #placed = "";
  /** The width for which the height of the picture is kept, that height, and true if the list stands next to it. */
  #kept = { width: 0, height: 0, isWide: false };
  #active = "";
  #said = "";
  #followed: HTMLElement | null = null;
  #refused: ReturnType<typeof setTimeout> | undefined;

  constructor(
    model: Model<MachineTraits>,
    element: HTMLElement,
    stream: Stream<Step>,
    outlines: Outlines,
    signal: AbortSignal,
  ) {
    this.#model = model;
    this.#stream = stream;
    this.#outlines = outlines;
    this.#card = new SampleCard(element, "machine", model, stream, () => this.#draw(), signal);
    this.#entries = new Entries(({ at }) => this.#show(at), signal);
    this.#band = new MachineBand((time) => this.#show(time), this.#card.redraw, signal);
    this.#card.picture.append(this.#picture.root, this.#empty);
    this.#card.picture.after(this.#entries.root, this.#band.root);
    const pace = make("span", "");
    pace.append(this.#time, " \u00b7 ", this.#rate);
    this.#card.footer.append(pace, this.#refusal);
    onAbort(signal, () => clearTimeout(this.#refused));
    this.#sayActive = throttle(() => this.#say(), SAY_MS, signal);
    onChange(model, ["_outline"], this.#card.redraw, signal);
    onMessage(model, ({ refused }: { refused?: string }) => refused && this.#refuse(refused), signal);
  }

  #draw(): void {
    const step = this.#stream.shown;
    const { mode = "running", version, fired = [], states = [] } = this.#stream.about as MachineAbout;
    const { key = "", machines = [] } = this.#outlines.of(step?.key);
    this.#active = step && mode !== "ended" ? activeText(machines, step) : "";
    this.#card.update([version ? `v${version}` : "", mode === "running" ? "" : mode, this.#active], "step", false);
    setHidden(this.#empty, step !== null);
    setHidden(this.#picture.root, !step);
    setText(this.#empty, this.#card.waiting("state machine"));
    this.#card.picture.style.paddingTop = `${PADDING + this.#card.noticeHeight}px`;
    setHidden(this.#entries.root, !step);
    const newest: MachineAbout = this.#model.get("_about");
    this.#entries.update(newest.fired ?? [], this.#stream.paused ? (step?.arrived ?? 0) : null);
    setText(this.#time, step ? `${toFixed(step.time, 2)} s` : "");
    const { paused, rate } = this.#stream;
    const isLive = !this.#card.pulse.silence && !lacksKernel(this.#model);
    const now = isLive ? mode : "last step";
    setText(this.#rate, now === "running" && rate ? `${toFixed(rate, 1)} Hz` : now);
    const end = paused ? "frozen" : now === "running" ? "now" : now;
    this.#band.update(
      step ? states : [],
      depthOf(machines),
      step?.arrived ?? 0,
      paused,
      end,
      this.#card.width,
      this.#card.theme,
    );
    if (!step) return;
    this.#place(key, machines, step);
    const isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const { failed = "" } = this.#stream.about as MachineAbout;
    const canGo = isLive && !paused && mode !== "ended";
    this.#picture.update({ step, fired, isInForce: mode !== "ended", isCalm, failed, canGo });
    this.#follow();
    if (this.#active !== this.#said) this.#sayActive();
  }

  /**
   * Places the states again for another version or size. A picture that is too wide shrinks; if that is not enough,
   * only active states are unfolded. Its height stays, so that the code below it does not move, unless the picture
   * would shrink too much. If the layout sets the height, the picture shrinks to that, too.
   */
  #place(key: string, machines: MachineOutline[], step: Step): void {
    const { width, picture, noticeHeight, size } = this.#card;
    const isSet = getComputedStyle(picture).minHeight === "0px";
    const { font } = this.#card.theme;
    const base = [key, width, font, noticeHeight, isSet && size.height].join();
    if (this.#placed === base || this.#placed === `${base} ${this.#active}`) return;
    const measure = (text: string) => {
      if (!this.#text) return 8 * text.length;
      this.#text.font = `600 13px ${font}`;
      return Math.ceil(this.#text.measureText(text).width);
    };
    const room = width - 2 * PADDING;
    if (this.#kept.width !== width) this.#kept = { width, height: 0, isWide: false };
    const frame = 2 * PADDING + noticeHeight + 1;
    let placed = place(machines, { measure, room, isOpen: () => true });
    this.#placed = base;
    const isTooHigh = isSet && placed.height * UNFOLDED > size.height - frame;
    if ((placed.width * UNFOLDED > room || isTooHigh) && machines.some(hasMachines)) {
      const isOpen = (state: StateOutline, machine: MachineOutline) => isActive(machine, state, step);
      placed = place(machines, { measure, room, isOpen });
      this.#placed = `${base} ${this.#active}`;
    }
    const isNew = !this.#kept.height;
    if (isNew) this.#kept.isWide = placed.width <= room - LIST_WIDTH;
    if (placed.width * UNFOLDED > room - LIST_WIDTH) this.#kept.isWide = false;
    const across = (room - (this.#kept.isWide ? LIST_WIDTH : 0)) / placed.width;
    const down = ((isSet ? size.height : this.#kept.height) - frame) / placed.height;
    let scale = Math.max(SMALLEST, Math.min(1, across));
    if (isSet || (!isNew && down >= KEPT)) scale = Math.max(SMALLEST, Math.min(scale, down));
    this.#kept.height = Math.max(this.#kept.height, Math.ceil(placed.height * scale) + frame);
    picture.style.setProperty("--rw-kept-height", `${this.#kept.height}px`);
    this.#picture.draw(placed, scale);
    this.#card.root.classList.toggle("rw-machine-wide", this.#kept.isWide);
  }

  /** Scrolls a picture that is wider than the card to an active state, once for each, unless it is pointed at. */
  #follow(): void {
    const { picture } = this.#card;
    const leaf = picture.querySelector<HTMLElement>('[data-active="leaf"]');
    if (!leaf || leaf === this.#followed || picture.matches(":hover")) return;
    this.#followed = leaf;
    const { offsetLeft: left, offsetWidth: width } = leaf;
    const isSeen = left >= picture.scrollLeft && left + width <= picture.scrollLeft + picture.clientWidth;
    if (!isSeen) picture.scrollLeft = left + (width - picture.clientWidth) / 2;
  }

  /** Tells the machine to go to a state at its next step. Python ignores a message that a busy kernel has delayed. */
  #go(path: string): void {
    this.#model.send({ go: path, beat: this.#model.get("_beat") });
  }

  #show(time: number): void {
    this.#refuse(this.#stream.freezeAt(time) ? "" : REFUSAL);
  }

  /** Shows for a while why a request of the user was not carried out. */
  #refuse(words: string): void {
    clearTimeout(this.#refused);
    setText(this.#refusal, words);
    if (!words) return;
    this.#card.say([words]);
    this.#refused = setTimeout(() => setText(this.#refusal, ""), REFUSAL_MS);
  }

  #say(): void {
    if (this.#active === this.#said) return;
    this.#said = this.#active;
    this.#card.say([this.#active ? `active: ${this.#active}` : "no active state"]);
  }
}

function hasMachines({ states }: MachineOutline): boolean {
  return states.some(({ machines }) => machines.length > 0);
}

/** Levels of machines. */
function depthOf(machines: MachineOutline[]): number {
  const within = machines.flatMap(({ states }) => states.map(({ machines }) => depthOf(machines)));
  return machines.length ? 1 + Math.max(0, ...within) : 0;
}
