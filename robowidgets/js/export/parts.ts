/** The content of a script element of the page, written by Python: facts, and the bytes after them. */
interface Part<F> {
  facts: F;
  bytes: Uint8Array<ArrayBuffer>;
}

/** The script elements with parts of a kind, in the order of the page. */
export function findParts(kind: string): HTMLElement[] {
  return [...document.querySelectorAll<HTMLElement>(`script[data-part="${kind}"]`)];
}

/** Inflates a part: a uint32 with the length of a JSON text, that text, and bytes; deflated, in base85. */
export async function readPart<F>(part: string): Promise<Part<F>> {
  const packed = fromBase85(part);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const all = await new Response(stream).arrayBuffer();
  const length = new DataView(all).getUint32(0, true);
  const text = new TextDecoder().decode(new Uint8Array(all, 4, length));
  return { facts: JSON.parse(text) as F, bytes: new Uint8Array(all, 4 + length) };
}

/** The digits of base85 as Python writes them, with a comma for "<". */
const DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;,=>?@^_`{|}~";

/** Four bytes for every five digits; the last group has as many bytes fewer as it lacks digits. */
function fromBase85(text: string): Uint8Array<ArrayBuffer> {
  const values = new Uint8Array(128);
  for (let i = 0; i < DIGITS.length; i++) values[DIGITS.charCodeAt(i)] = i;
  const missing = (5 - (text.length % 5)) % 5;
  const digits = text + "~".repeat(missing);
  const view = new DataView(new ArrayBuffer((digits.length / 5) * 4));
  for (let at = 0; at < digits.length; at += 5) {
    let number = 0;
    for (let i = at; i < at + 5; i++) number = number * 85 + (values[digits.charCodeAt(i)] as number);
    view.setUint32((at / 5) * 4, number);
  }
  return new Uint8Array(view.buffer, 0, view.byteLength - missing);
}

/** Shows why the page has no widgets, above the first samples as text, which are in the page. */
export function explain(reason: string): void {
  const place = document.querySelector<HTMLElement>(".rw-page-text");
  const line = document.querySelector<HTMLElement>(".rw-page-why");
  if (!place || !line) throw new Error(reason);
  place.hidden = false;
  place.classList.add("rw-page-failed");
  line.textContent = reason;
}
