import { onAbort } from "./events.ts";

/**
 * The boxes whose style depends on their contents. They replace rules with `:has()`, which the browser would check up
 * to the root at each change of the page, some 20 ms in JupyterLab.
 */
const BOXES =
  ".rw-one-screen, .rw-one-screen *, .widget-hbox, .jp-OutputArea, .jp-OutputArea-child, .jp-OutputArea-output";

/** The element of the host around a card. */
interface Room extends HTMLElement {
  rwBoxes?: HTMLElement[];
}

/** Shows stylesheets a card, by `data-rw-holds` on the element around it and on the boxes around that. */
export function enter(room: Room, card: HTMLElement, signal: AbortSignal): void {
  const names = [...card.classList].flatMap((name) => (name.startsWith("rw-") ? [name.slice(3)] : []));
  room.classList.add("rw-room");
  room.dataset.rwHolds = names.join(" ");
  onAbort(signal, () => {
    room.classList.remove("rw-room");
    delete room.dataset.rwHolds;
    for (const box of room.rwBoxes ?? []) updateSoon(box);
    // JupyterLab keeps the room, and with it the boxes that it has found.
    delete room.rwBoxes;
  });
  onConnected(
    room,
    () => {
      room.rwBoxes = [];
      enterBoxes(room);
    },
    signal,
  );
}

/** Updates the boxes that an element of a card has left, and those around it now; does nothing before it has any. */
export function enterBoxes(room: Room): void {
  const before = room.rwBoxes;
  if (!before) return;
  const boxes: HTMLElement[] = [];
  for (let box = room.parentElement; box; box = box.parentElement) if (box.matches(BOXES)) boxes.push(box);
  if (before.length === boxes.length && boxes.every((box, i) => box === before[i])) return;
  room.rwBoxes = boxes;
  for (const box of [...before, ...boxes]) updateSoon(box);
}

/** Adds a word about a card's contents to its boxes, or removes it. */
export function setHeld(card: HTMLElement, word: string, isSo: boolean): void {
  const room: Room | null = card.parentElement;
  const words = new Set(room?.dataset.rwHolds?.split(" "));
  if (!room || words.has(word) === isSo) return;
  if (isSo) words.add(word);
  else words.delete(word);
  room.dataset.rwHolds = [...words].join(" ");
  for (const box of room.rwBoxes ?? []) updateSoon(box);
}

/** The boxes that are updated before the page is laid out: each once, for any number of new cards. */
const changed = new Set<HTMLElement>();

function updateSoon(box: HTMLElement): void {
  if (!changed.size) queueMicrotask(updateAll);
  changed.add(box);
}

function updateAll(): void {
  const boxes = [...changed];
  changed.clear();
  for (const box of boxes) update(box);
}

/** Updates the words of a box: the words of all cards in it. */
function update(box: HTMLElement): void {
  const words = new Set<string>();
  const add = (name: string) => words.add(name);
  for (const room of box.querySelectorAll<Room>(".rw-room")) room.dataset.rwHolds?.split(" ").forEach(add);
  if (words.size && box.querySelector(".rw-one-screen")) words.add("screen");
  if (box.querySelector(".rw-whole .rw-room") && box.querySelector(".rw-wides .rw-room")) words.add("columns");
  const all = [...words].join(" ");
  if (!all) delete box.dataset.rwHolds;
  else if (box.dataset.rwHolds !== all) box.dataset.rwHolds = all;
}

/** Calls back once an element is in the page: before its layout there, or, in a shadow root, after that. */
function onConnected(element: HTMLElement, callback: () => void, signal: AbortSignal): void {
  if (element.isConnected) {
    callback();
    return;
  }
  const stop = () => {
    for (const observer of observers) observer.disconnect();
  };
  const look = () => {
    if (!element.isConnected) return;
    stop();
    callback();
  };
  // The document does not observe additions to a shadow root, but a layout changes their sizes.
  const [additions, sizes] = [new MutationObserver(look), new ResizeObserver(look)];
  const observers = [additions, sizes];
  additions.observe(document, { childList: true, subtree: true });
  sizes.observe(element);
  onAbort(signal, stop);
}
