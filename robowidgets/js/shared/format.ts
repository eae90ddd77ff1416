const MINUS = "\u2212";

/** A number with a fixed count of decimals, a real minus sign, and no minus on a zero. */
export function toFixed(value: number, decimals: number): string {
  if (Number.isNaN(value)) return "NaN";
  if (!Number.isFinite(value)) return value > 0 ? "+inf" : `${MINUS}inf`;
  const text = Math.abs(value).toFixed(decimals);
  return value < 0 && Number(text) !== 0 ? MINUS + text : text;
}

const KILOMETRE = 1000;

/** Number of decimals that distinguish numbers up to a size: two, and more if the size is below 0.1; at most six. */
export function decimalsFor(size: number): number {
  return Math.min(6, Math.max(2, 1 - Math.floor(Math.log10(size))));
}

/**
 * Metres with the decimals of a picture that reaches so far, and more if a distance would read as 0: "2.54 m". From 1
 * km on, kilometres to the metre: "1.234 km".
 */
export function toMetres(value: number, reach = 1): string {
  if (Number.isFinite(value) && Math.abs(value) >= KILOMETRE) return `${toFixed(value / KILOMETRE, 3)} km`;
  const text = toFixed(value, decimalsFor(reach));
  return value !== 0 && Number(text) === 0 ? toShortMetres(value) : `${text} m`;
}

/** Metres, or kilometres, with as many decimals as the number needs: "6 m", "4.5 m", "0.0025 m", "1.2 km". */
export function toShortMetres(value: number): string {
  const isFar = Number.isFinite(value) && Math.abs(value) >= KILOMETRE;
  const shown = isFar ? value / KILOMETRE : value;
  const text = toFixed(shown, Math.min(6, decimalsFor(Math.abs(shown) || 1) + 1));
  return `${text.includes(".") ? text.replace(/\.?0+$/, "") : text} ${isFar ? "km" : "m"}`;
}

/** Radians as degrees within ±180 with one decimal. Rounds twice, so that 28.75° in float32 is "28.8°", not "28.7°". */
export function toDegrees(radians: number): string {
  const degrees = Math.round((radians * 180_000) / Math.PI) / 1000;
  return `${toFixed(Math.abs(degrees) > 180 ? degrees - 360 * Math.round(degrees / 360) : degrees, 1)}°`;
}

/** The unit in which angles are shown. */
export type AngleUnit = "deg" | "rad";

/** Radians as degrees with one decimal, or as radians with three, within half a turn either way. */
export function toAngle(radians: number, unit: AngleUnit): string {
  if (unit === "deg") return toDegrees(radians);
  const turn = 2 * Math.PI;
  const isWithin = Math.abs(radians) <= Math.PI + 0.0005;
  return `${toFixed(isWithin ? radians : radians - turn * Math.round(radians / turn), 3)} rad`;
}

/** A whole number in groups of three: "12 480". */
export function toCount(value: number): string {
  return String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}

/** "1 ray", "1040 rays". */
export function toMany(count: number, noun: string): string {
  return `${toCount(count)} ${noun}${count === 1 ? "" : "s"}`;
}

/** "1st", "22nd", "97th". */
export function toOrdinal(number: number): string {
  const tens = number % 100;
  const word = tens > 10 && tens < 14 ? "th" : (["th", "st", "nd", "rd"][number % 10] ?? "th");
  return `${number}${word}`;
}

/** An age: "2.3 s", "3 min", "2 h". */
export function toAge(ms: number, decimals = 1): string {
  const seconds = ms / 1000;
  if (seconds < 60) return `${toFixed(seconds, decimals)} s`;
  return seconds < 3600 ? `${Math.floor(seconds / 60)} min` : `${Math.floor(seconds / 3600)} h`;
}

export const MINUTE = 60;

/**
 * Seconds from the start of a recording, from a minute on in minutes and hours: "12:05.30".
 *
 * @param of the longest of the times next to it, which determines the form
 */
export function toMinutes(seconds: number, decimals: number, of = seconds): string {
  if (!(of >= MINUTE)) return toFixed(seconds, decimals);
  // Round once, so that no "60" appears.
  const parts = Math.round(Math.abs(seconds) * 10 ** decimals);
  const whole = Math.floor(parts / 10 ** decimals);
  const minutes = Math.floor(whole / MINUTE);
  const sign = seconds < 0 && parts ? MINUS : "";
  const rest = decimals ? `.${String(parts % 10 ** decimals).padStart(decimals, "0")}` : "";
  const end = `${toTwo(whole % MINUTE)}${rest}`;
  return of < MINUTE * MINUTE
    ? `${sign}${minutes}:${end}`
    : `${sign}${Math.floor(minutes / MINUTE)}:${toTwo(minutes % MINUTE)}:${end}`;
}

function toTwo(count: number): string {
  return String(count).padStart(2, "0");
}

/** Date and time of day in UTC, of seconds since the epoch: "2024-05-03" and "14:32:05". */
export function toClock(seconds: number): [date: string, timeOfDay: string] {
  const text = new Date(Math.round(seconds * 1000)).toISOString();
  return [text.slice(0, 10), text.slice(11, 19)];
}

/** Words of an error or a remedy as a sentence, with a capital and a full stop. */
export function asSentence(words: string): string {
  return words && `${words.charAt(0).toUpperCase()}${words.slice(1)}${/[.?!]$/.test(words) ? "" : "."}`;
}

/** The side of the robot on which an angle lies. */
export function sideOf(angle: number): string {
  const turned = Math.atan2(Math.sin(angle), Math.cos(angle));
  if (Math.abs(turned) < 0.0009) return "ahead";
  if (Math.abs(turned) > Math.PI - 0.0009) return "behind";
  return turned > 0 ? "left" : "right";
}
