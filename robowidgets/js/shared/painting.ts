import { make, zoomOf } from "./dom.ts";

/** Characters that are illegal in XML. */
const FORBIDDEN = /[^\P{C}\p{Cf}\p{Co}\n]/gu;

/** Paints a card, as it is at the moment of the call, on a canvas: from a copy with inlined styles, which fetches nothing. */
export async function paint(root: HTMLElement, css: string, ratio: number): Promise<HTMLCanvasElement> {
  const { width, height } = root.getBoundingClientRect();
  const { backgroundColor, fontFamily } = getComputedStyle(root);
  const card = root.cloneNode(true) as HTMLElement;
  card.classList.add("rw-still");
  keepInputs(root, card);
  const copy = inScreen(root, card);
  copy.style.cssText += `;--jp-layout-color0:${backgroundColor};font-family:${fontFamily}`;
  copy.append(make("style", "", css));
  // Copies, which the browser encodes in the background.
  const canvases = [...root.querySelectorAll("canvas")].map(copyOf);
  const urls = await Promise.all(canvases.map(toUrl));
  const xml = new XMLSerializer()
    .serializeToString(copy)
    .replace(/<canvas(.*?)><\/canvas>/g, (_, attributes) => `<img src="${urls.shift()}"${attributes}/>`)
    .replace(FORBIDDEN, "");
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}"><foreignObject width="100%" height="100%">${xml}</foreignObject></svg>`;
  const image = new Image();
  image.src = `data:image/svg+xml,${encodeURIComponent(svg)}`;
  await image.decode();
  const paper = make("canvas", "");
  paper.width = Math.round(width * ratio);
  paper.height = Math.round(height * ratio);
  paper.getContext("2d")?.drawImage(image, 0, 0, paper.width, paper.height);
  return paper;
}

/** Gives the controls of a copy their values, which are no attributes. */
function keepInputs(root: HTMLElement, copy: HTMLElement): void {
  const copies = copy.querySelectorAll("input");
  for (const [i, input] of root.querySelectorAll("input").entries()) copies[i]?.setAttribute("value", input.value);
}

/**
 * The copy of a card within empty copies of its screen, whose rules for its layout it needs.
 *
 * @returns the outermost copy, with the scale that the element has in the page
 */
function inScreen(root: HTMLElement, card: HTMLElement): HTMLElement {
  const screen = root.closest<HTMLElement>(".rw-one-screen");
  const zoom = zoomOf(root);
  if (!screen) {
    card.style.zoom = String(zoom);
    return card;
  }
  const { width, height } = root.getBoundingClientRect();
  card.style.cssText += `;visibility:visible;position:fixed;inset:0 auto auto 0;width:${width / zoom}px;height:${height / zoom}px`;
  let copy = card;
  for (let at: HTMLElement = root; at !== screen; at = at.parentElement as HTMLElement) {
    const around = at.parentElement as HTMLElement;
    const outer = around.cloneNode(false) as HTMLElement;
    outer.append(...[...around.children].map((inner) => (inner === at ? copy : inner.cloneNode(false))));
    copy = outer;
  }
  copy.style.cssText += `;visibility:hidden;width:${screen.offsetWidth}px;zoom:${zoomOf(screen)}`;
  return copy;
}

function copyOf(canvas: HTMLCanvasElement): HTMLCanvasElement {
  const copy = Object.assign(make("canvas", ""), { width: canvas.width, height: canvas.height });
  if (canvas.width && canvas.height) copy.getContext("2d")?.drawImage(canvas, 0, 0);
  return copy;
}

function toUrl(canvas: HTMLCanvasElement): Promise<string> {
  return new Promise((resolve, reject) => {
    canvas.toBlob((blob) => {
      if (!blob) return resolve("data:,"); // without any pixels
      const reader = new FileReader();
      reader.onload = () => resolve(reader.result as string);
      reader.onerror = () => reject(reader.error);
      reader.readAsDataURL(blob);
    });
  });
}
