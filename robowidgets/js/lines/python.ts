/** A part of a line of Python with its kind, for its colour. */
export type Token = [kind: "" | "word" | "text" | "number" | "comment" | "name", text: string];

const WORDS = new Set(
  (
    "and as assert async await break class continue def del elif else except finally for from global if import in is " +
    "lambda match case nonlocal not or pass raise return try while with yield None True False"
  ).split(" "),
);
const PARTS =
  /(#.*)|([rbfuRBFU]{0,2}(?:"""[\s\S]*?(?:"""|$)|'''[\s\S]*?(?:'''|$)|"(?:\\.|[^"\\])*(?:"|$)|'(?:\\.|[^'\\])*(?:'|$)))|(\b\d[\w.]*)|([^\W\d]\w*)|(\s+|[^\w\s#"']+|.)/gu;

/** Returns the parts of a line of Python. It does not recognize texts of several lines. */
export function tokensOf(line: string): Token[] {
  const tokens: Token[] = [];
  let isDefined = false;
  for (const [text, comment, quoted, number, name] of line.matchAll(PARTS)) {
    const kind = comment
      ? "comment"
      : quoted
        ? "text"
        : number
          ? "number"
          : name
            ? WORDS.has(name)
              ? "word"
              : isDefined
                ? "name"
                : ""
            : "";
    if (text.trim()) isDefined = text === "def" || text === "class";
    const last = tokens.at(-1);
    if (last && last[0] === kind && kind === "") last[1] += text;
    else tokens.push([kind, text]);
  }
  return tokens;
}
