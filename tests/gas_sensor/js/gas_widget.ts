import { Reader } from "robowidgets/shared/bytes.ts";
import { make, setText } from "robowidgets/shared/dom.ts";
import type { Model } from "robowidgets/shared/model.ts";
import { perModel } from "robowidgets/shared/per_model.ts";
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

class GasView {
  constructor(model: Model<SampleTraits>, element: HTMLElement, stream: Stream<Gas>, signal: AbortSignal) {
    const concentration = make("div", "rw-gas-ppm");
    const draw = () => {
      const { status = "" } = stream.about as GasAbout;
      card.update([status].filter(Boolean), "gas sensor");
      const ppm = stream.shown?.ppm ?? Number.NaN;
      setText(concentration, Number.isNaN(ppm) ? card.waiting("gas") : `${ppm.toFixed(0)} ppm`);
    };
    const card = new SampleCard(element, "gas", model, stream, draw, signal);
    card.picture.append(concentration);
  }
}

/** Its views share one stream. */
export default perModel(GasView, (model, signal) => [new Stream(model, decodeGas, signal)]);
