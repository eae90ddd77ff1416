import type { Model } from "./model.ts";

interface Script<T> {
  initialize(given: { model: Model<T>; signal: AbortSignal }): void;
  render(given: { model: Model<T>; el: HTMLElement; signal: AbortSignal }): void;
}

/**
 * The script of a widget whose views share something, such as a stream of samples: it is made once for each model.
 * @param make returns what the views share
 */
export function perModel<T, S extends unknown[]>(
  View: new (model: Model<T>, element: HTMLElement, ...shared: [...S, AbortSignal]) => unknown,
  make: (model: Model<T>, signal: AbortSignal) => [...S],
): () => Script<T> {
  return () => {
    let shared: [...S];
    return {
      initialize({ model, signal }) {
        shared = make(model, signal);
      },
      render({ model, el, signal }) {
        new View(model, el, ...shared, signal);
      },
    };
  };
}
