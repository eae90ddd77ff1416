import { onAbort } from "./events.ts";

/**
 * The boxes that stylesheets give a place by what is in them. In place of rules by `:has()`: each change of the page would
 * have these looked at up to the root, some 20 ms in JupyterLab.
 */
const BOXES =
  ".rw-one-screen, .rw-one-screen *, .widget-hbox, .jp-OutputArea, .jp-OutputArea-child, .jp-OutputArea-output";

/** The element that the host has made for a card. */
interface Room extends HTMLElement {
  rwBoxes?: HTMLElement[];
}

/** Has stylesheets know of a card, by `data-rw-holds` on the element around it and on the boxes around that. */
export function enter(room: Room, card: HTMLElement, signal: AbortSignal): void {
  const names = [...card.classList].flatMap((name) => (name.startsWith("rw-") ? [name.slice(3)] : []));
  room.classList.add("rw-room");
  room.dataset.rwHolds = names.join(" ");
  onAbort(signal, () => {
    room.classList.remove("rw-room");
    delete room.dataset.rwHolds;
    for (const box of room.rwBoxes ?? []) updateSoon(box);
    // JupyterLab keeps the room, and with it what it knows.
    delete room.rwBoxes;
  });
  onConnected(
    room,
    () => {
      const boxes: HTMLElement[] = [];
      for (let box = room.parentElement; box; box = box.parentElement) if (box.matches(BOXES)) boxes.push(box);
      room.rwBoxes = boxes;
      for (const box of boxes) updateSoon(box);
    },
    signal,
  );
}

/** Says a word about what a card shows, or takes it back. */
export function setHeld(card: HTMLElement, word: string, isSo: boolean): void {
  const room: Room | null = card.parentElement;
  const words = new Set(room?.dataset.rwHolds?.split(" "));
  if (!room || words.has(word) === isSo) return;
  if (isSo) words.add(word);
  else words.delete(word);
  room.dataset.rwHolds = [...words].join(" ");
  for (const box of room.rwBoxes ?? []) updateSoon(box);
}

/** The boxes that are brought up to date before the page is laid out: each once, however many cards have come. */
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

/** Brings the words of a box up to date: those of all cards in it. */
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

/** Calls back once an element is in the page: before it is laid out there, but in a shadow root, after that. */
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
  // The document hears nothing of what is put into a shadow root; that it is laid out, it does.
  const [additions, sizes] = [new MutationObserver(look), new ResizeObserver(look)];
  const observers = [additions, sizes];
  additions.observe(document, { childList: true, subtree: true });
  sizes.observe(element);
  onAbort(signal, stop);
}
