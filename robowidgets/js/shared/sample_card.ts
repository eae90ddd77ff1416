import { Bar } from "./bar.ts";
import { Card } from "./card.ts";
import { make, makeButton, makeIcon, PAUSE, PLAY, setHidden, setText } from "./dom.ts";
import { isPlain, on } from "./events.ts";
import { toAge, toCount, toFixed } from "./format.ts";
import { Lamps } from "./lamps.ts";
import { lacksKernel, type Model, NO_KERNEL, onChange } from "./model.ts";
import { SECONDS, toNumberLines } from "./numbers.ts";
import { offerPng } from "./png.ts";
import { Pulse } from "./pulse.ts";
import type { Frame, Stream } from "./stream.ts";
import { TimeLinesView } from "./time_lines_view.ts";
import type { Moment, SampleTraits } from "./traits.ts";

const STEPS: Record<string, number> = { ",": -1, ".": 1 };

/** A card with the newest of many samples, which the user can freeze, save, and step through its history. */
export class SampleCard extends Card {
  readonly lamps: Lamps;
  readonly pulse: Pulse<SampleTraits>;
  /**
   * More numbers of a sample that are drawn over the last seconds, in addition to the program's; null without
   * more.
   */
  alsoNumbers: ((moment: Moment) => Record<string, number | null>) | null = null;
  readonly #model: Model<SampleTraits>;
  readonly #stream: Stream<Frame>;
  #canFreeze = true;
  readonly #freeze: HTMLButtonElement;
  readonly #freezeText = make("span", "");
  /** The words around the number are hidden in a narrow card. */
  readonly #freezeWords = ["rw-word", "rw-number", "rw-word"].map((name) => make("span", name));
  readonly #bar: Bar;
  readonly #tellFacts = () => this.#drawFacts();
  readonly #numbers: TimeLinesView;
  #known: string[] = [];
  #paced = true;
  #paused: boolean | null = null;

  constructor(
    element: HTMLElement,
    kind: string,
    model: Model<SampleTraits>,
    stream: Stream<Frame>,
    draw: () => void,
    signal: AbortSignal,
  ) {
    super(element, kind, model, draw, signal);
    this.#model = model;
    this.#stream = stream;
    this.#freeze = makeButton("rw-freeze", "", () => stream.toggle(), signal);
    this.#freeze.ariaLabel = null;
    this.#freezeText.append(...this.#freezeWords);
    this.controls.append(this.#freeze);
    offerPng(this, model, signal);
    this.#bar = new Bar(stream, signal);
    this.lamps = new Lamps(stream, this, signal);
    this.picture.after(this.lamps.root, this.#bar.root);
    this.#numbers = new TimeLinesView(this.picture, () => this.#drawNumbers(), signal);
    stream.listen(this.redraw, signal);
    this.pulse = new Pulse(model, ["_beat", "_frame"], () => model.get("_beat") > 0, this.redraw, signal);
    onChange(model, ["_source"], this.redraw, signal);
    on(this.header, "pointerenter", () => this.#tellAll(), signal);
    on(this.root, "keydown", (event) => this.#onKey(event), signal);
  }

  /** False for a card that always shows the time of a player. */
  set canFreeze(can: boolean) {
    this.#canFreeze = can;
    setHidden(this.#freeze, !can);
  }

  /** Inserts controls of the widget before the freeze button. */
  addControls(...elements: HTMLElement[]): void {
    for (const element of elements) this.controls.insertBefore(element, this.#freeze);
  }

  /** The text of a picture before the first sample. */
  waiting(noun: string): string {
    if (this.#stream.since) return `frozen before the first ${noun}`;
    if (lacksKernel(this.#model)) return NO_KERNEL;
    return this.#model.get("_source").status || `waiting for ${/^[aeiou]/.test(noun) ? "an" : "a"} ${noun}`;
  }

  /**
   * Updates header, notice, bar and freeze button.
   * @param facts about the source, shown after the title
   * @param noun for a sample: "scan"
   * @param paced true if samples have a steady rate; else silence is normal
   */
  update(facts: string[], noun: string, paced = true): void {
    const { error, waits = false } = this.#model.get("_about");
    const { paused, since, about, shown, place } = this.#stream;
    const { notes = [], problems = [] } = about;
    this.#known = facts.filter(Boolean);
    this.#paced = paced;
    this.texts.ask(this.#tellFacts);
    const said = error ? [error + (shown ? ` Showing the last good ${noun}.` : ""), ...notes] : notes;
    const source = this.#model.get("_source");
    const isError = Boolean(error || source.error);
    // An empty picture shows the status of the source itself.
    const lines = [source.error ?? "", (shown && source.status) || "", ...said].filter(Boolean);
    this.updateFrame(lines, isError ? "error" : said.length + problems.length ? "note" : "status", problems);
    this.lamps.update();
    this.#bar.update(this.footer.hidden ? null : place);
    this.#drawNumbers();

    this.root.classList.toggle("rw-frozen", paused);
    this.root.classList.toggle("rw-waits", waits);
    if (this.#paused !== paused) {
      this.#paused = paused;
      this.#freeze.ariaPressed = String(paused);
      // The accessible name is the text, which a screen reader reads together with this.
      this.#freeze.title = paused ? "Show the newest again (space)" : "Freeze the picture (space)";
      this.#freeze.replaceChildren(makeIcon(paused ? PLAY : PAUSE), this.#freezeText);
    }
    const state = paused ? ["Frozen · ", toCount(since), " since"] : ["Freeze", "", ""];
    for (const [i, element] of this.#freezeWords.entries()) setText(element, state[i] ?? "");
  }

  /** Milliseconds of silence; 0 while all is well. */
  get #silenceMs(): number {
    return this.#paced ? this.#stream.silence : 0;
  }

  /** True while the present is unknown: the source is silent, or Python waits for the next sample. */
  get isStale(): boolean {
    return this.#isSilent || this.#model.get("_about").waits === true;
  }

  /** True while the newest sample is too old for the present. */
  get #isSilent(): boolean {
    return this.#silenceMs > 0 || this.pulse.silence > 0 || this.#model.get("_source").lost === true;
  }

  /** Draws the numbers that the program plots, up to the sample on show. */
  #drawNumbers(): void {
    const { about, paused } = this.#stream;
    const also = this.alsoNumbers;
    const lines = about.numbers || also ? toNumberLines(this.#stream.last(Infinity), also) : null;
    this.#numbers.draw(lines, SECONDS, paused ? "frozen" : "now", this.theme, this.size.ratio);
  }

  /** Shows facts, rate and silence of the source; calls itself again while the source is silent. */
  #drawFacts(): void {
    const { live, rate } = this.#stream;
    const silence = this.#silenceMs;
    const pace = live && this.#paced && rate ? [`${toFixed(rate, 1)} Hz`] : [];
    this.updateFacts([...this.#known, ...pace]);
    const { age } = this.#stream.about; // of a recording's sample, which needs no kernel
    const said = !age && lacksKernel(this.#model) ? NO_KERNEL : `no data for ${toAge(silence)}`;
    this.updateSilence(silence ? said : this.pulse.words, this.#isSilent);
    if (silence) this.texts.ask(this.#tellFacts);
  }

  /** Sets the tooltip of the header: all facts about the source, line by line. */
  #tellAll(): void {
    const { arrived } = this.#stream;
    const { topic = this.#model.get("title"), type } = this.#model.get("_source");
    const age = arrived && `newest ${toAge(performance.now() - arrived)} ago`;
    this.header.title = [topic, type, this.facts, age].filter(Boolean).join("\n");
  }

  #onKey(event: KeyboardEvent): void {
    if (!isPlain(event)) return;
    if (this.#stream.step(STEPS[event.key] ?? 0)) event.preventDefault();
    if (event.key !== " " || event.target instanceof HTMLButtonElement || !this.#canFreeze) return;
    event.preventDefault();
    // The bar is hidden when the picture is released. Focus must not leave the card with it.
    const isInPicture = event.target !== this.picture && this.picture.contains(event.target as Element);
    if (!isInPicture) this.picture.focus({ preventScroll: true });
    this.#stream.toggle();
  }
}
