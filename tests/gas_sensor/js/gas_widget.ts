import { Reader } from "robowidgets/shared/bytes.ts";
import { make, setText } from "robowidgets/shared/dom.ts";
import type { Initialized, Rendered } from "robowidgets/shared/model.ts";
import { SampleCard } from "robowidgets/shared/sample_card.ts";
import { type Frame, readHead, Stream } from "robowidgets/shared/stream.ts";
import type { About, SampleTraits } from "robowidgets/shared/traits.ts";

interface Gas extends Frame {
  ppm: number;
}

interface GasAbout extends About {
  status?: string;
}

function decodeGas(bytes: DataView): Gas {
  const reader = new Reader(bytes);
  return { ...readHead(reader), ppm: reader.float64() };
}

/** Called once per model, so that its views share one stream. */
export default () => {
  let stream: Stream<Gas>;
  return {
    initialize({ model, signal }: Initialized<SampleTraits>) {
      stream = new Stream(model, decodeGas, signal);
    },
    render({ model, el, signal }: Rendered<SampleTraits>) {
      const concentration = make("div", "rw-gas-ppm");
      const draw = () => {
        const { status = "" } = stream.about as GasAbout;
        card.update([status].filter(Boolean), "gas sensor");
        const ppm = stream.shown?.ppm ?? Number.NaN;
        setText(concentration, Number.isNaN(ppm) ? card.waiting("gas") : `${ppm.toFixed(0)} ppm`);
      };
      const card = new SampleCard(el, "gas", model, stream, draw, signal);
      card.picture.append(concentration);
    },
  };
};
