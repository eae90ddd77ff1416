import { Reader } from "../../../robowidgets/js/shared/bytes.ts";
import { make, setText } from "../../../robowidgets/js/shared/dom.ts";
import type { Initialized, Rendered } from "../../../robowidgets/js/shared/model.ts";
import { SampleCard } from "../../../robowidgets/js/shared/sample_card.ts";
import { type Frame, readHead, Stream } from "../../../robowidgets/js/shared/stream.ts";
import type { About, SampleTraits } from "../../../robowidgets/js/shared/traits.ts";

interface Numbered extends Frame {
  value: number;
}

interface NumberAbout extends About {
  unit?: string;
}

function decodeNumber(bytes: DataView): Numbered {
  const reader = new Reader(bytes);
  return { ...readHead(reader), value: reader.float64() };
}

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<Numbered>;
  return {
    initialize({ model, signal }: Initialized<SampleTraits>) {
      stream = new Stream(model, decodeNumber, signal);
    },
    render({ model, el, signal }: Rendered<SampleTraits>) {
      const value = make("div", "rw-number-value");
      const draw = () => {
        const { unit = "" } = stream.about as NumberAbout;
        card.update([], "number");
        setText(value, stream.shown ? `${stream.shown.value} ${unit}`.trim() : card.waiting("number"));
      };
      const card = new SampleCard(el, "number", model, stream, draw, signal);
      card.picture.append(value);
    },
  };
};
