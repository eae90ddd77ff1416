import type { Card } from "./card.ts";
import { make, makeButton, makeIcon, setLabel } from "./dom.ts";
import { type Model, onMessage } from "./model.ts";
import { paint } from "./painting.ts";
import type { NamedTraits } from "./traits.ts";

const LABEL = "Save as PNG";
const ICON = "M5 1h2v4h2.5l-3.5 3.5-3.5-3.5h2.5z M1.5 9.5h9v1.5h-9z";

/** Offers the card as a PNG: to the user by a button, and to Python, whose requests carry a number. */
export function offerPng(card: Card, model: Model<NamedTraits>, signal: AbortSignal): void {
  const take = async () => {
    const ratio = Math.max(2, devicePixelRatio);
    card.drawNow(ratio);
    const picture = paint(card.root, model.get("_style"), ratio);
    card.drawNow();
    return (await picture).toDataURL();
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
