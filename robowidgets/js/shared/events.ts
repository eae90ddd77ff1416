type Events = HTMLElementEventMap & Pick<WindowEventMap, "pagehide"> & Pick<DocumentEventMap, "visibilitychange">;

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

/** Calls back when the signal aborts: the view or the model has ended. */
export function onAbort(signal: AbortSignal, callback: () => void): void {
  signal.addEventListener("abort", callback, { once: true });
}

/** Whether a key is pressed without Ctrl, Alt or Meta. */
export function isPlain({ ctrlKey, altKey, metaKey }: KeyboardEvent): boolean {
  return !(ctrlKey || altKey || metaKey);
}
