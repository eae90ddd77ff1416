import { watchSize } from "../shared/canvas.ts";
import { make, makeButton, makeIcon, mount, PAUSE, PLAY, pointIn, set, setHidden, setText } from "../shared/dom.ts";
import { isPlain, on } from "../shared/events.ts";
import { MINUTE, toClock, toFixed, toMinutes } from "../shared/format.ts";
import { keepKeys } from "../shared/keys.ts";
import { type Model, NO_KERNEL, setTraits } from "../shared/model.ts";
import { setHeld } from "../shared/room.ts";
import { perAnimationFrame } from "../shared/schedule.ts";
import { StateBand } from "../shared/states/band.ts";
import { statesAt, toWords } from "../shared/states/states.ts";
import { followTheme, type Theme } from "../shared/theme.ts";
import { watchUndo } from "../shared/undo.ts";
import { toDensity } from "./density.ts";
import { actionOf, isBarsAlone, SPEEDS, usesItself } from "./keys.ts";
import { Labels } from "./labels.ts";
import { MarkList } from "./mark_list.ts";
import type { Playback } from "./playback.ts";
import type { PlayerTraits } from "./traits.ts";

const REPEAT =
  "M3 2.5h4.5a3 3 0 0 1 3 3v.7H9.3v-.7a1.8 1.8 0 0 0-1.8-1.8H3v1.6L.5 3.1 3 .9z M9 9.5H4.5a3 3 0 0 1-3-3v-.7h1.2v.7a1.8 1.8 0 0 0 1.8 1.8H9V6.7l2.5 2.2L9 11.1z";
const DECIMALS = 2;
/** Width of the slider's handle in pixels; its middle never reaches the ends of the track. */
const HANDLE = 12;

/** The bar that moves through a recording: buttons, the time, and a slider with marks on it. */
export class PlayerBar {
  readonly #model: Model<PlayerTraits>;
  readonly #playback: Playback;
  readonly #root = make("div", "rw-card rw-player");
  readonly #play: HTMLButtonElement;
  readonly #loop: HTMLButtonElement;
  readonly #moment = make("span", "rw-play-time");
  readonly #time = make("b", "rw-play-now");
  readonly #duration = make("span", "rw-play-duration");
  readonly #clock = make("span", "rw-play-clock");
  readonly #date = make("span", "rw-play-date");
  readonly #timeOfDay = make("span", "");
  readonly #slider = make("input", "rw-slider");
  readonly #marks = make("div", "rw-play-marks");
  readonly #walk = make("span", "rw-play-walk");
  readonly #speed = make("select", "rw-button rw-play-speed");
  readonly #words = make("span", "rw-play-words");
  readonly #note = make("div", "rw-play-note");
  readonly #list: MarkList;
  readonly #track = make("div", "rw-play-line");
  readonly #states: StateBand;
  readonly #labels: Labels;
  readonly #theme: () => Theme;
  #drawn: unknown[] = [];
  #icon = "";
  /** Pixels of the slider on which marks stand. */
  #width = 0;

  constructor(model: Model<PlayerTraits>, element: HTMLElement, playback: Playback, signal: AbortSignal) {
    this.#model = model;
    this.#playback = playback;
    const back = makeButton("rw-step", "One scan back (,)", () => playback.step(-1), signal, "\u2039");
    const forth = makeButton("rw-step", "One scan on (.)", () => playback.step(1), signal, "\u203a");
    this.#play = makeButton("rw-play", "Play (space)", () => playback.toggle(), signal);
    const onLoop = () => setTraits(model, { loop: !model.get("loop") });
    this.#loop = makeButton("rw-loop", "Play it again and again, the selection if there is one (l)", onLoop, signal);
    this.#loop.append(makeIcon(REPEAT));
    this.#makeSlider(signal);
    this.#makeSpeed(signal);
    this.#words.role = "status";
    this.#clock.append(this.#date, this.#timeOfDay);
    this.#moment.append(this.#time, this.#duration, this.#clock);
    const track = this.#track;
    const draw = perAnimationFrame(() => this.#draw(), signal);
    const onPick = (time: number) => playback.seek(time);
    const onPoint = (time: number | null) => playback.point(time);
    this.#states = new StateBand("rw-play-states", 0, { onPick, onPoint }, draw, signal);
    this.#labels = new Labels(model, playback, draw, signal);
    track.append(this.#marks, this.#slider, this.#words, this.#labels.lane, this.#states.root);
    const toMark = (direction: -1 | 1) => () => playback.toMark(direction);
    this.#list = new MarkList((time) => playback.seek(time), signal);
    on(this.#list.toggle, "click", () => this.#draw(), signal);
    this.#walk.append(
      this.#list.toggle,
      makeButton("rw-step", "To the mark before (p)", toMark(-1), signal, "p"),
      makeButton("rw-step", "To the next mark (n)", toMark(1), signal, "n"),
    );
    const { button, row } = this.#labels;
    const end = [this.#walk, this.#speed, this.#loop, button, this.#note, row.root, this.#list.rows];
    this.#root.append(back, this.#play, forth, this.#moment, track, ...end);
    this.#root.tabIndex = -1;
    on(this.#root, "keydown", (event) => this.#onKey(event), signal);
    // On the document: the bar may be created before it is inserted next to the widgets that it moves.
    on(document, "keydown", (event) => this.#isLeftOver(event) && this.#onKey(event), signal);
    keepKeys(this.#root, signal);
    watchUndo(this.#root, draw, signal);
    mount(element, this.#root, signal);

    playback.listen(draw, signal);
    const onSize = ({ width }: { width: number }) => {
      this.#width = width;
      draw();
    };
    watchSize(this.#marks, onSize, signal);
    this.#theme = followTheme(this.#root, model, signal, draw);
    draw();
  }

  #makeSlider(signal: AbortSignal): void {
    const slider = this.#slider;
    slider.type = "range";
    slider.step = "any";
    slider.title = "Time in the recording (arrows: 1 s, with shift 10 s)";
    slider.ariaLabel = "Time in the recording";
    this.#placeSlider();
    on(slider, "input", () => this.#playback.seek(Number(slider.value)), signal);
    on(slider, "pointermove", (event) => this.#onPointer(event), signal);
    on(slider, "pointerleave", () => this.#playback.point(null), signal);
  }

  /** Also before the first drawing, for which the bar may wait: the user may already move it. */
  #placeSlider(): void {
    const { shown, begin, duration } = this.#playback;
    this.#slider.min = String(begin);
    this.#slider.max = String(duration);
    if (Number(this.#slider.value) !== shown) this.#slider.value = String(shown);
  }

  #makeSpeed(signal: AbortSignal): void {
    this.#speed.title = "How fast it plays (+ and \u2212)";
    this.#speed.ariaLabel = "How fast it plays";
    const onSpeed = () => setTraits(this.#model, { speed: Number(this.#speed.value) });
    on(this.#speed, "change", onSpeed, signal);
  }

  /** A finger does not hover, and dragging already seeks. */
  #onPointer(event: PointerEvent): void {
    if (event.pointerType === "touch" || event.buttons) return;
    const part = (pointIn(this.#slider, event).x - HANDLE / 2) / (this.#slider.offsetWidth - HANDLE);
    const { begin, duration } = this.#playback;
    this.#playback.point(begin + part * (duration - begin));
  }

  /** Returns true if a key was pressed on a widget that the bar moves, and the widget did not use it. */
  #isLeftOver({ target, key, defaultPrevented }: KeyboardEvent): boolean {
    if (defaultPrevented || isBarsAlone(key) || !(target instanceof Element)) return false;
    // Rerun's viewer has no card; it uses its keys itself.
    const card = target.closest(".rw-card");
    return card !== null && this.#root.closest(".rw-recording")?.contains(card) === true;
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event) || usesItself(event.target as HTMLElement, event.key)) return;
    const action = actionOf(event.key, event.shiftKey);
    if (action) action(this.#playback, this.#model);
    else if (event.key === "a") this.#labels.press();
    else if (event.key !== "Escape" || !this.#labels.cancel()) return;
    event.preventDefault();
    event.stopPropagation();
  }

  #draw(): void {
    const { shown, begin, duration, playing, waits } = this.#playback;
    setText(this.#time, toMinutes(shown, DECIMALS, duration));
    const whole = toMinutes(duration, DECIMALS);
    setText(this.#duration, ` / ${whole}${duration < MINUTE ? " s" : ""}`);
    // Reserve the final width, so that its neighbours stay at their places.
    this.#time.style.minWidth = `${whole.length}ch`;
    this.#drawClock(shown);
    this.#placeSlider();
    const states = this.#model.get("states");
    const active = statesAt(states, shown).map(([, , path]) => toWords(path));
    const state = active.length ? `, ${active.at(-1)}` : "";
    set(this.#slider, "ariaValueText", `${toFixed(shown, DECIMALS)} of ${toFixed(duration, DECIMALS)} seconds${state}`);
    this.#labels.update(begin, duration);
    const hasLabels = !this.#labels.lane.hidden;
    this.#track.classList.toggle("rw-play-with-states", states.length > 0 || hasLabels);
    setHeld(this.#root, "labels", hasLabels);
    setHeld(this.#root, "states", states.length > 0);
    this.#states.update(states, [begin, duration], shown, this.#theme());
    const icon = playing ? PAUSE : PLAY;
    if (this.#icon !== icon) {
      this.#icon = icon;
      this.#play.replaceChildren(makeIcon(icon));
      this.#play.title = playing ? "Stop here (space)" : "Play (space)";
      this.#play.ariaLabel = this.#play.title;
    }
    set(this.#loop, "ariaPressed", String(this.#model.get("loop")));
    const { held } = this.#playback;
    const [from, to] = (held ?? []).map((time) => toMinutes(time, 0, duration));
    const part = held && `${NO_KERNEL}: it has ${from} to ${to}${duration < MINUTE ? " s" : ""}`;
    const waiting = waits ? (part ?? this.#waiting) : "";
    setText(this.#words, this.#model.get("_status") || waiting || this.#labels.words || this.#playback.lost);
    // They leave the knob free.
    this.#words.classList.toggle("rw-left", shown - begin > (duration - begin) / 2);
    setText(this.#note, this.#model.get("_note"));
    this.#drawSpeed();
    this.#drawMarks(begin, duration);
    const { marks } = this.#playback;
    setHidden(this.#walk, marks.length === 0);
    this.#list.update(marks, shown);
  }

  /** The text while the player waits: for the kernel, or in a page in a file for its own data. */
  get #waiting(): string {
    const bytes = this.#model.get("_unpacking");
    return bytes ? `unpacking ${toFixed(bytes / 1e6, 1)} MB` : "waiting for the kernel";
  }

  #drawClock(time: number): void {
    const start = this.#model.get("_start");
    setHidden(this.#clock, start === null);
    const [date, timeOfDay] = start === null ? ["", ""] : toClock(start + time);
    setText(this.#date, `${date} `);
    setText(this.#timeOfDay, `${timeOfDay} UTC`);
    // Programs take seconds.
    const whole = [`${toFixed(time, DECIMALS)} s`, start === null ? "" : this.#clock.textContent]
      .filter(Boolean)
      .join("\n");
    if (this.#moment.title !== whole) this.#moment.title = whole;
  }

  #drawSpeed(): void {
    const speed = this.#model.get("speed");
    const speeds = [...new Set([...SPEEDS, speed])].sort((a, b) => a - b);
    if ([...this.#speed.options].map(({ value }) => value).join() !== speeds.join()) {
      this.#speed.replaceChildren(...speeds.map((value) => new Option(`${value}\u00d7`, String(value))));
    }
    if (this.#speed.value !== String(speed)) this.#speed.value = String(speed);
  }

  /** Draws the marks once the width of the bar is known: marks that would touch are joined. */
  #drawMarks(begin: number, duration: number): void {
    const width = this.#width;
    if (!width) return;
    const marks = this.#model.get("marks");
    const selection = this.#model.get("selection");
    // Compare by identity: there may be thousands of marks, and this runs in every frame while it plays.
    const drawn = [marks, selection, begin, duration, width];
    if (drawn.every((one, i) => one === this.#drawn[i])) return;
    this.#drawn = drawn;
    const makeMark = (className: string, left: number, width: number, label: string) => {
      const mark = make("span", className);
      mark.style.left = `${left}%`;
      mark.style.width = `${width}%`;
      mark.title = label;
      return mark;
    };
    const toPart = (time: number) => (100 * (time - begin)) / (duration - begin);
    const [from, to] = (selection ?? [begin, begin]).map(toPart) as [number, number];
    const elements = selection ? [makeMark("rw-play-selected", from, to - from, "selected")] : [];
    for (const { left, width: wide, count, share, label } of toDensity(marks, begin, duration, width)) {
      const name = count > 1 ? "rw-play-dense" : "rw-play-mark";
      const mark = makeMark(name, (100 * left) / width, (100 * wide) / width, label);
      if (count > 1) mark.style.setProperty("--rw-share", `${Math.round(100 * share)}%`);
      elements.push(mark);
    }
    this.#marks.replaceChildren(...elements);
  }
}
