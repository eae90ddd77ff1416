import { onAbort } from "./events.ts";

/** A widget that is frozen, released and stepped with the others of its view. */
export interface Member {
  /** The group, or "" for a widget alone. */
  readonly group: string;
  /** The robot that it is connected to, or "". */
  readonly robot: string;
  /** Arrival of the oldest sample it can step back to; -Infinity while it has dropped none. */
  readonly oldest: number;
  readonly paused: boolean;
  freeze(): void;
  release(): void;
  /** Shows the newest sample of a moment. */
  showAt(arrived: number): void;
  /** Another one of its view was frozen, released, added or removed. */
  onOthers?(): void;
}

const KEY: unique symbol = Symbol.for("robowidgets together") as never;

/** All members of the page: the scripts of different widgets share only this object. */
const page = globalThis as { [KEY]?: Set<Member> };

/** Enters a member until the signal aborts. */
export function join(member: Member, signal: AbortSignal): void {
  page[KEY] ??= new Set();
  page[KEY].add(member);
  tellOthers(member);
  onAbort(signal, () => {
    page[KEY]?.delete(member);
    tellOthers(member);
  });
}

/** Notifies the other members of its view that a member was frozen or released. */
export function tellOthers(member: Member): void {
  for (const other of othersOf(member)) other.onOthers?.();
}

/** Freezes members, or releases them. */
export function setFrozen(members: Member[], isFrozen: boolean): void {
  for (const member of members) {
    if (isFrozen) member.freeze();
    else member.release();
  }
}

/** The other members of a member's group. A group that is named after a robot has all members of the robot. */
export function othersOf(member: Member): Member[] {
  const isWith = (one: Member, other: Member) =>
    one.group !== "" && (one.group === other.group || one.group === other.robot);
  return [...(page[KEY] ?? [])].filter((other) => other !== member && (isWith(member, other) || isWith(other, member)));
}
