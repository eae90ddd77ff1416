import { type Model, onMessage } from "../shared/model.ts";
import type { Stream } from "../shared/stream.ts";
import type { Picture } from "./frame.ts";
import type { Statistics } from "./region.ts";
import type { Pixel } from "./text.ts";
import type { ImageTraits } from "./traits.ts";

/** What Python answers. */
interface Answer {
  of?: number;
  pixel?: number[];
  values?: (number | string)[];
  region?: number[];
  statistics?: Omit<Statistics, "isExact">;
}

/** What Python knows of the picture on show that the page does not have; it is asked once for each. */
export class Answers {
  readonly #model: Model<ImageTraits>;
  readonly #stream: Stream<Picture>;
  /** By question, of the picture of a number; what was asked is not known yet. */
  #known = new Map<string, Answer | null>();
  #of = -1;
  /** Of the picture before: they stand until those on this one come, or numbers would flicker from picture to picture. */
  #before = new Map<string, Answer | null>();

  /** @param onAnswer called when another one has come */
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

  /** The values of a pixel of a picture as they are; undefined: not known yet, or not on show. */
  valuesAt({ row, column }: Pixel, picture: Picture): number[] | undefined {
    return this.#ask({ pixel: [row, column] }, picture)?.values?.map(Number);
  }

  /** What is in all of a region of a picture; undefined: not known yet, or not on show. */
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
