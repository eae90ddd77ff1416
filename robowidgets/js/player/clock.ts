/** Date and time of day in UTC, of seconds since the epoch: "2024-05-03" and "14:32:05". */
export function toClock(seconds: number): [date: string, timeOfDay: string] {
  const text = new Date(Math.round(seconds * 1000)).toISOString();
  return [text.slice(0, 10), text.slice(11, 19)];
}
