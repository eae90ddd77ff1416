import { type Model, onMessage } from "../shared/model.ts";
import type { Stream } from "../shared/stream.ts";
import type { Picture } from "./frame.ts";
import type { Statistics } from "./region.ts";
import type { Pixel } from "./text.ts";
import type { ImageTraits } from "./traits.ts";

/** An answer of Python. */
interface Answer {
  of?: number;
  pixel?: number[];
  values?: (number | string)[];
  region?: number[];
  statistics?: Omit<Statistics, "isExact">;
}

/** Facts about the picture on show that only Python has; each is requested once. */
export class Answers {
  readonly #model: Model<ImageTraits>;
  readonly #stream: Stream<Picture>;
  /** Answers on the picture of a number, by question; null while an answer is pending. */
  #known = new Map<string, Answer | null>();
  #of = -1;
  /**
   * Answers on the previous picture: they stay until new ones arrive, or numbers would flicker from picture to picture.
   */
  #before = new Map<string, Answer | null>();

  /** @param onAnswer called with each new answer */
  constructor(model: Model<ImageTraits>, stream: Stream<Picture>, onAnswer: () => void, signal: AbortSignal) {
    this.#model = model;
    this.#stream = stream;
    const take = (answer: Answer) => {
      const { of, pixel, region } = answer;
      if (of !== this.#of || (!pixel && !region)) return;
      this.#known.set(JSON.stringify(pixel ? { pixel } : { region }), answer);
      onAnswer();
    };
    onMessage(model, take, signal);
  }

  /** The exact values of a pixel; undefined if they are not known yet, or not on show. */
  valuesAt({ row, column }: Pixel, picture: Picture): number[] | undefined {
    return this.#ask({ pixel: [row, column] }, picture)?.values?.map(Number);
  }

  /** The statistics of a region of a picture; undefined if they are not known yet, or not on show. */
  statistics(region: number[], picture: Picture): Statistics | undefined {
    const { statistics } = this.#ask({ region }, picture) ?? {};
    return statistics && { ...statistics, isExact: true };
  }

  #ask(question: { pixel: number[] } | { region: number[] }, picture: Picture): Answer | undefined {
    if (picture !== this.#stream.shown || !this.#model.get("_answers")) return undefined;
    if (this.#of !== picture.sequence) {
      this.#before = this.#known;
      this.#known = new Map();
      this.#of = picture.sequence;
    }
    const key = JSON.stringify(question);
    if (!this.#known.has(key)) {
      this.#known.set(key, null);
      this.#model.send({ ...question, of: picture.sequence });
    }
    return this.#known.get(key) ?? this.#before.get(key) ?? undefined;
  }
}
