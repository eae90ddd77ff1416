/** What Python has put into a script element of the page: facts, and the bytes after them. */
export interface Part<F> {
  facts: F;
  bytes: Uint8Array<ArrayBuffer>;
}

/** The script elements with parts of a kind, in the order of the page. */
export function findParts(kind: string): HTMLElement[] {
  return [...document.querySelectorAll<HTMLElement>(`script[data-part="${kind}"]`)];
}

/** Inflates a part: a uint32 with the length of a JSON text, that text, and bytes; deflated, in base64. */
export async function readPart<F>(element: HTMLElement): Promise<Part<F>> {
  const packed = Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const all = await new Response(stream).arrayBuffer();
  const length = new DataView(all).getUint32(0, true);
  const text = new TextDecoder().decode(new Uint8Array(all, 4, length));
  return { facts: JSON.parse(text) as F, bytes: new Uint8Array(all, 4 + length) };
}

/** Shows why nothing is on show, above the first samples as text, which are in the page. */
export function explain(reason: string): void {
  const place = document.querySelector<HTMLElement>(".rw-page-text");
  const line = document.querySelector<HTMLElement>(".rw-page-why");
  if (!place || !line) throw new Error(reason);
  place.hidden = false;
  place.classList.add("rw-page-failed");
  line.textContent = reason;
}
