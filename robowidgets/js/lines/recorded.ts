import { makeButton, setHidden, setLabel, setText } from "../shared/dom.ts";
import { type Model, onMessage } from "../shared/model.ts";
import type { Trace } from "./steps.ts";
import type { LinesTraits } from "./traits.ts";

/** The part of the view for lines over a recording: their graphs, the chosen line, and the button that runs them. */
export class Recorded {
  readonly button: HTMLButtonElement;
  /** The reason why Python could not mark the spans of a line; else empty. */
  refused = "";
  readonly #model: Model<LinesTraits>;
  #of: LinesTraits["_drive"] | null = null;
  #traces = new Map<string, { kind: string; trace: Trace }>();

  constructor(model: Model<LinesTraits>, redraw: () => void, signal: AbortSignal) {
    this.#model = model;
    this.button = makeButton("rw-lines-run", "", () => model.send({ compute: true }), signal, "");
    onMessage(
      model,
      ({ refused = "" }: { refused?: string }) => {
        this.refused = refused;
        redraw();
      },
      signal,
    );
  }

  /** The span in seconds; null for a robot that drives now. */
  get span(): [from: number, to: number] | null {
    const { from, to } = this.#model.get("_drive");
    return from === undefined || to === undefined ? null : [from, to];
  }

  /** The kind and the levels of a line over the recording; undefined before they are known. */
  graphOf(key: string, line: number): { kind: string; trace: Trace } | undefined {
    const drive = this.#model.get("_drive");
    if (drive !== this.#of) {
      this.#of = drive;
      this.#traces = toTraces(drive);
    }
    return this.#traces.get(`${key}:${line}`);
  }

  /** The number of the line whose spans are marked; undefined without one. */
  get chosen(): number | undefined {
    return this.#model.get("_chosen").line;
  }

  /** Marks the spans of a line in the player, or of none if it is marked already. */
  toggle(line: number | undefined): void {
    this.refused = "";
    this.#model.send({ when: line === this.chosen ? null : (line ?? null) });
  }

  /** The spans that are marked, in words; empty without any. */
  get words(): string {
    const { spans, what } = this.#model.get("_chosen");
    if (spans === undefined) return this.refused;
    const times = spans === 0 ? "never" : spans === 1 ? "once" : `${spans} times`;
    return `${what}: ${times}${spans ? "; n and p go there" : ""}, Escape shows the other marks`;
  }

  drawButton(): void {
    const offer = this.#model.get("_offer");
    setText(this.button, offer);
    setLabel(this.button, offer);
    setHidden(this.button, !offer);
  }
}

/** Returns the kinds and levels of lines, by function and line. */
export function toTraces({
  times = [],
  lines = {},
}: LinesTraits["_drive"]): Map<string, { kind: string; trace: Trace }> {
  const traces = new Map<string, { kind: string; trace: Trace }>();
  for (const [key, found] of Object.entries(lines)) {
    for (const [line, kind, levels] of found) {
      traces.set(`${key}:${line}`, { kind, trace: times.map((time, i) => [time, levels[i] ?? null]) });
    }
  }
  return traces;
}
