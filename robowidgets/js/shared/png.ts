import type { Card } from "./card.ts";
import { make, makeButton, makeIcon, setLabel } from "./dom.ts";
import { type Model, onMessage } from "./model.ts";
import type { NamedTraits } from "./traits.ts";

const LABEL = "Save as PNG";
const ICON = "M5 1h2v4h2.5l-3.5 3.5-3.5-3.5h2.5z M1.5 9.5h9v1.5h-9z";
/** Characters that are illegal in XML. */
const FORBIDDEN = /[^\P{C}\p{Cf}\p{Co}\n]/gu;

/** Offers the card as a PNG: to the user by a button, and to Python, whose requests carry a number. */
export function offerPng(card: Card, model: Model<NamedTraits>, signal: AbortSignal): void {
  const take = async () => {
    const ratio = Math.max(2, devicePixelRatio);
    card.drawNow(ratio);
    const png = toPng(card, model.get("_style"), ratio);
    card.drawNow();
    return png;
  };
  const save = (url: string) => {
    const link = make("a", "");
    link.href = url;
    // Swedish dates are in the form of ISO 8601, in local time.
    const words = `${model.get("title")} ${new Date().toLocaleString("sv")}`.match(/[^\s/:]+/g);
    link.download = `${words?.join("-")}.png`;
    link.click();
    return LABEL;
  };
  const onClick = () => {
    take()
      .then(save, (error) => `Not saved: ${error}`)
      .then((label) => setLabel(button, label));
  };
  const button = makeButton("", LABEL, onClick, signal);
  button.append(makeIcon(ICON));
  card.controls.append(button);

  const onAsked = async ({ png }: { png?: number }) => {
    // A view that is scrolled away may have no size. Python reports an error if no view answers.
    if (!png || !card.root.offsetWidth) return;
    const answer = await take().then(
      (url) => ({ url }),
      (error) => ({ error: String(error) }),
    );
    model.send({ png, ...answer });
  };
  onMessage(model, onAsked, signal);
}

/** The card at the moment of the call, as a data URL: drawn from a copy with inlined styles, which fetches nothing. */
async function toPng({ root, theme }: Card, css: string, ratio: number): Promise<string> {
  const { width, height } = root.getBoundingClientRect();
  const copy = root.cloneNode(true) as HTMLElement;
  copy.classList.add("rw-still");
  copy.style.cssText = `--jp-layout-color0:${theme.background};font-family:${theme.font}`;
  copy.append(make("style", "", css));
  const canvases = [...root.querySelectorAll("canvas")];
  const xml = new XMLSerializer()
    .serializeToString(copy)
    .replace(
      /<canvas(.*?)><\/canvas>/g,
      (_, attributes) => `<img src="${canvases.shift()?.toDataURL()}"${attributes}/>`,
    )
    .replace(FORBIDDEN, "");
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}"><foreignObject width="100%" height="100%">${xml}</foreignObject></svg>`;
  const image = new Image();
  image.src = `data:image/svg+xml,${encodeURIComponent(svg)}`;
  await image.decode();
  const paper = make("canvas", "");
  paper.width = Math.round(width * ratio);
  paper.height = Math.round(height * ratio);
  paper.getContext("2d")?.drawImage(image, 0, 0, paper.width, paper.height);
  return paper.toDataURL();
}
