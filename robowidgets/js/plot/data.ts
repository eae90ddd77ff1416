import { type Model, onChange } from "../shared/model.ts";
import type { Span } from "../shared/time_axis.ts";
import { decodePlot, type PlotFrame, type Rows } from "./frame.ts";
import { merged } from "./rows.ts";
import type { PlotTraits } from "./traits.ts";

/** The lines that Python has sent, decoded once for all views of a widget. */
export class PlotData {
  #frame: PlotFrame | null = null;
  #detail: PlotFrame | null = null;
  #lines: Rows[] | null = null;

  constructor(model: Model<PlotTraits>, signal: AbortSignal) {
    const take = () => {
      this.#frame = decodePlot(model.get("_lines"));
      this.#detail = decodePlot(model.get("_detail"));
      this.#lines = null;
    };
    onChange(model, ["_lines", "_detail"], take, signal);
    take();
  }

  /** The first and the last time of all lines; null before the first. */
  get whole(): Span | null {
    if (!this.#frame?.lines.length) return null;
    const [first, last] = this.#frame.whole;
    return [first, Math.max(last, this.#part?.whole[1] ?? last)];
  }

  /** The lines in the finest detail that the page has. */
  get lines(): Rows[] {
    const part = this.#part;
    this.#lines ??= (this.#frame?.lines ?? []).map((all, i) => {
      const own = part?.lines[i];
      return part && own ? merged(all, own, part.span) : all;
    });
    return this.#lines;
  }

  /** Returns true if Python has more values than the page for a span in so many columns. */
  lacks([start, end]: Span, columns: number): boolean {
    const frame = this.#frame;
    if (!frame || frame.lines.every(({ total, times }) => times.length >= total)) return false;
    const [first, last] = this.whole ?? [0, 0];
    const pixel = (end - start) / columns;
    return [frame, this.#part].every((one) => {
      if (!one) return true;
      const [from, to] = one.span;
      return (
        from > Math.max(start, first) || to < Math.min(end, last) || (to - from) / one.columns > pixel * (1 + 1e-6)
      );
    });
  }

  /** The part, if it is one of these lines. */
  get #part(): PlotFrame | null {
    return this.#detail && this.#detail.edition === this.#frame?.edition ? this.#detail : null;
  }
}
