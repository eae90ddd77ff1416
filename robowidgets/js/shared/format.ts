const MINUS = "\u2212";

/** A number with a fixed count of decimals, a real minus sign, and no minus on a zero. */
export function toFixed(value: number, decimals: number): string {
  if (Number.isNaN(value)) return "NaN";
  if (!Number.isFinite(value)) return value > 0 ? "+inf" : `${MINUS}inf`;
  const text = Math.abs(value).toFixed(decimals);
  return value < 0 && Number(text) !== 0 ? MINUS + text : text;
}

/** Metres with two decimals: "2.54 m". */
export function toMetres(value: number): string {
  return `${toFixed(value, 2)} m`;
}

/** Metres with as many decimals as the number needs, at most three: "6 m", "4.5 m". */
export function toShortMetres(value: number): string {
  return `${toFixed(value, 3).replace(/\.?0+$/, "")} m`;
}

/** Radians as degrees within ±180 with one decimal. Rounds twice, so that 28.75° in float32 is "28.8°", not "28.7°". */
export function toDegrees(radians: number): string {
  const degrees = Math.round((radians * 180_000) / Math.PI) / 1000;
  return `${toFixed(Math.abs(degrees) > 180 ? degrees - 360 * Math.round(degrees / 360) : degrees, 1)}°`;
}

/** A whole number in groups of three: "12 480". */
export function toCount(value: number): string {
  return String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}

/** "1 ray", "1040 rays". */
export function toMany(count: number, noun: string): string {
  return `${toCount(count)} ${noun}${count === 1 ? "" : "s"}`;
}

/** How long ago: "2.3 s", "3 min", "2 h". */
export function toAge(ms: number, decimals = 1): string {
  const seconds = ms / 1000;
  if (seconds < 60) return `${toFixed(seconds, decimals)} s`;
  return seconds < 3600 ? `${Math.floor(seconds / 60)} min` : `${Math.floor(seconds / 3600)} h`;
}

/** Date and time of day in UTC, of seconds since the epoch: "2024-05-03" and "14:32:05". */
export function toClock(seconds: number): [date: string, timeOfDay: string] {
  const text = new Date(Math.round(seconds * 1000)).toISOString();
  return [text.slice(0, 10), text.slice(11, 19)];
}
