type Events = HTMLElementEventMap &
  Pick<WindowEventMap, "afterprint" | "beforeprint" | "pagehide"> &
  Pick<DocumentEventMap, "visibilitychange"> & { "rw-look": Event };

/** Calls back on events of a target, until the signal aborts. */
export function on<K extends keyof Events>(
  target: EventTarget,
  type: K,
  callback: (event: Events[K]) => void,
  signal: AbortSignal,
  options: AddEventListenerOptions = {},
): void {
  target.addEventListener(type, callback as (event: Event) => void, { ...options, signal });
}

const ends = new WeakMap<AbortSignal, (() => void)[]>();

/**
 * Calls back when the signal aborts: the view or the model has ended. One listener serves all: a page has many models.
 */
export function onAbort(signal: AbortSignal, callback: () => void): void {
  const callbacks = ends.get(signal) ?? [];
  if (!callbacks.length) {
    ends.set(signal, callbacks);
    signal.addEventListener("abort", () => callbacks.splice(0).forEach((end) => void end()), { once: true });
  }
  callbacks.push(callback);
}

/** Returns true for an event on an element over a picture that takes clicks itself: it has the class `rw-over`. */
export function isOver({ target }: Event): boolean {
  return target instanceof Element && target.closest(".rw-over") !== null;
}

/** Returns true if a key is pressed without Ctrl, Alt or Meta. */
export function isPlain({ ctrlKey, altKey, metaKey }: KeyboardEvent): boolean {
  return !(ctrlKey || altKey || metaKey);
}
