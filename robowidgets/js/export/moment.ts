import type { PageModel } from "./model.ts";

/** A moment in the address of a page, such as "#t=24.1&ray=105". */
export interface Moment {
  /** Seconds from the start of the recording. */
  time?: number;
  /** Index of the pinned ray. */
  ray?: number;
  /** Number of the widget on a page with several ones, from 0. */
  widget?: number;
}

/** The models of a widget on the page, by the names of their scripts. */
export type Named = { widget: string; model: PageModel }[];

/** The moment in the part of an address after "#"; null without one. */
export function parseMoment(hash: string): Moment | null {
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const read = (name: string, isWhole: boolean): number | undefined => {
    const text = given.get(name);
    const value = text?.trim() ? Number(text) : Number.NaN;
    return value >= 0 && Number.isFinite(value) && (!isWhole || Number.isInteger(value)) ? value : undefined;
  };
  const [time, ray, widget] = [read("t", false), read("ray", true), read("widget", true)];
  if (time === undefined && ray === undefined) return null;
  return {
    ...(time !== undefined && { time }),
    ...(ray !== undefined && { ray }),
    ...(widget !== undefined && { widget }),
  };
}

/** The part of an address with a moment. Its time is never before the sample on show. */
export function toHash({ time, ray, widget }: Moment): string {
  const parts = [
    ...(time === undefined ? [] : [`t=${Math.ceil(time * 1000 - 1e-6) / 1000}`]),
    ...(ray === undefined ? [] : [`ray=${ray}`]),
    ...(widget ? [`widget=${widget}`] : []),
  ];
  return parts.length ? `#${parts.join("&")}` : "";
}

const findModel = (named: Named, name: string) => named.find(({ widget }) => widget === name)?.model;

/** The moment on show. */
export function momentOf(named: Named): Moment {
  const [player, laser] = [findModel(named, "player_widget"), findModel(named, "laser_widget")];
  const ray: number | null = laser?.get("pinned") ?? null;
  return { ...(player && { time: player.get("time") }), ...(ray !== null && { ray }) };
}

/** Shows a moment, and says so in the bar until the time changes. */
export function showMoment(named: Named, { time, ray }: Moment): void {
  const [player, laser] = [findModel(named, "player_widget"), findModel(named, "laser_widget")];
  if (ray !== undefined) laser?.set("pinned", ray);
  if (time === undefined || !player) return;
  const within = Math.min(player.get("duration"), Math.max(player.get("_begin"), time));
  player.set_state({ time: within, playing: false });
  player.set("_status", `${within.toFixed(2)} s, from the link`);
  const onTime = () => {
    player.off("change:time", onTime);
    player.set("_status", "");
  };
  player.on("change:time", onTime);
}
