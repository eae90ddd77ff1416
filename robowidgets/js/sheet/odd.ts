import type { OddFile } from "./traits.ts";

/** Greatest number of reasons in the text. */
const MOST = 3;

/** The problem of a file, without its name, which stands next to it. */
export function toReason({ name, problem }: OddFile): string {
  const last = name.slice(Math.max(name.lastIndexOf("/"), name.lastIndexOf("\\")) + 1);
  return problem.startsWith(last) ? problem.slice(last.length).replace(/^[\s:]+/, "") : problem;
}

/** "and 13 more: cut off (9), is empty (3) and others": the beginning of each reason, the most frequent first. */
export function toReasons(odd: OddFile[]): string {
  const reasons = new Map<string, number>();
  for (const file of odd) {
    const begins =
      toReason(file)
        .split(/[:;(]/, 1)[0]
        ?.trim()
        .replace(/\d[\d.,]*/g, "…") ?? "";
    reasons.set(begins, (reasons.get(begins) ?? 0) + 1);
  }
  const most = [...reasons].sort((a, b) => b[1] - a[1]);
  const parts = most.slice(0, MOST).map(([reason, number]) => `${reason} (${number.toLocaleString("en")})`);
  const others = most.length > MOST ? " and others" : "";
  return `and ${odd.length.toLocaleString("en")} more: ${parts.join(", ")}${others}`;
}

/** A path quoted for a shell, so that nothing in it is run. */
export function toShell(path: string): string {
  return /[$`!"]/.test(path) ? `'${path.replaceAll("'", "'\\''")}'` : `"${path}"`;
}
