/** `keyword.kwlist` of Python 3. */
const KEYWORDS = new Set(
  (
    "False None True and as assert async await break class continue def del elif else except finally for from global " +
    "if import in is lambda nonlocal not or pass raise return try while with yield"
  ).split(" "),
);

/** Returns true if a text is a valid name in Python code; any other must be quoted. */
export function isName(text: string): boolean {
  return /^[A-Za-z_]\w*$/.test(text) && !KEYWORDS.has(text);
}

/** A text as a Python literal, which allows the escapes of JSON. */
export function quoted(text: string): string {
  return JSON.stringify(text);
}

/** A finite number as a Python literal, whole ones without a point. */
export function toNumberCode(value: number): string {
  const [digits = "", exponent] = value.toExponential().split("e");
  const power = Number(exponent);
  if (power >= -4 && power < 16) return String(value);
  return `${digits}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
}
