/** Calls back on events of a target until the signal ends it. */
export function on<K extends keyof HTMLElementEventMap>(
  target: EventTarget,
  type: K,
  callback: (event: HTMLElementEventMap[K]) => void,
  signal: AbortSignal,
  options: AddEventListenerOptions = {},
): void {
  target.addEventListener(type, callback as (event: Event) => void, { ...options, signal });
}

/** Calls back when the signal ends what it is for. */
export function onAbort(signal: AbortSignal, callback: () => void): void {
  signal.addEventListener("abort", callback);
}

/** Whether a key is pressed alone, as the widgets' own are. */
export function isPlain({ ctrlKey, altKey, metaKey }: KeyboardEvent): boolean {
  return !(ctrlKey || altKey || metaKey);
}
