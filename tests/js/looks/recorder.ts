/** A canvas context that writes down what is drawn: each path, text and picture with its colour, one a line. */

/** Rounded to half a pixel. */
export const round = (value: number): string => (Number.isFinite(value) ? String(Math.round(value * 2) / 2 + 0) : "-");

/** Pixels; all fonts are as wide. */
export const letterWidth = (font: string): number => 0.6 * Number(/([\d.]+)px/.exec(font)?.[1] ?? 10);

/** Segments of a path that are written; the rest is a number and a sum that changes with it. */
const LONGEST = 12;

export function sum(values: ArrayLike<number> | string): string {
  let hash = 2166136261;
  for (let i = 0; i < values.length; i++) {
    const part = typeof values === "string" ? values.charCodeAt(i) : Math.round((values[i] ?? 0) * 2);
    hash = Math.imul(hash ^ part, 16777619) >>> 0;
  }
  return hash.toString(16).padStart(8, "0");
}

const shorten = (parts: string[]): string =>
  parts.length <= LONGEST
    ? parts.join(" ")
    : `${parts.slice(0, LONGEST).join(" ")} … ${parts.length - LONGEST} more, ${sum(parts.slice(LONGEST).join(" "))}`;

/** Letters of the commands of a path, as in SVG where it has them. */
const COMMANDS: Record<string, string> = {
  moveTo: "M",
  lineTo: "L",
  closePath: "Z",
  arc: "arc",
  arcTo: "arcTo",
  rect: "rect",
  roundRect: "roundRect",
  ellipse: "ellipse",
  quadraticCurveTo: "Q",
  bezierCurveTo: "C",
};

const show = (given: unknown): string => (typeof given === "number" ? round(given) : String(given));

/** Angles are in radians, which are not rounded to halves. */
const showArc = ([x, y, radius, from, to, back]: unknown[]): string => {
  const degrees = [from, to].map((angle) => Math.round((Number(angle) * 180) / Math.PI));
  const turn = degrees[1] === (degrees[0] ?? 0) + 360 ? "" : ` ${degrees.join("..")}${back ? " back" : ""}`;
  return `${[x, y, radius].map(show).join(",")}${turn}`;
};

const command = (name: string, given: unknown[]): string =>
  `${COMMANDS[name]}${name === "arc" ? showArc(given) : given.map(show).join(",")}`;

/** A path that is kept. */
export class RecordedPath {
  readonly parts: string[] = [];
}
for (const name of Object.keys(COMMANDS)) {
  Object.defineProperty(RecordedPath.prototype, name, {
    value(this: RecordedPath, ...given: unknown[]) {
      this.parts.push(command(name, given));
    },
  });
}

type State = Record<string, unknown>;

const START: State = {
  fillStyle: "#000000",
  strokeStyle: "#000000",
  lineWidth: 1,
  font: "10px sans-serif",
  textAlign: "start",
  globalAlpha: 1,
  dash: "",
  clip: "",
};

/** The calls that drew each canvas since it was last cleared. */
const logs = new WeakMap<object, string[]>();

export const drawn = (canvas: object): string[] => logs.get(canvas) ?? [];

interface Sized {
  width: number;
  height: number;
}

/** The context of a canvas. */
export function record(canvas: Sized): unknown {
  const log: string[] = [];
  logs.set(canvas, log);
  let state = { ...START };
  const kept: State[] = [];
  let path: string[] = [];
  const offsets: string[] = [];
  const more = () =>
    [
      Number(state.globalAlpha) < 1 ? `alpha ${Math.round(Number(state.globalAlpha) * 100) / 100}` : "",
      state.clip ? `in ${state.clip}` : "",
      ...offsets,
    ].filter(Boolean);
  const write = (...parts: unknown[]) => void log.push([...parts, ...more()].filter((part) => part !== "").join(" "));
  /** The start of the last line, if it is a path that another one of the same colour continues. */
  let begun = { start: "", end: "", parts: [] as string[], line: -1 };
  const paint = (start: string, parts: string[]) => {
    const end = more().join(" ");
    const goesOn = begun.line === log.length - 1 && begun.start === start && begun.end === end;
    if (goesOn) log.pop();
    begun = { start, end, parts: [...(goesOn ? begun.parts : []), ...parts], line: log.length };
    log.push([start, shorten(begun.parts), end].filter(Boolean).join(" "));
  };
  const outline = (given: unknown) => (given instanceof RecordedPath ? given.parts : path);
  const pen = () => ["stroke", state.strokeStyle, round(Number(state.lineWidth)), state.dash].filter(Boolean).join(" ");
  const picture = (source: Sized) => {
    const inner = drawn(source);
    return `${round(source.width)}×${round(source.height)}${inner.length ? ` of ${inner.length} drawings ${sum(inner.join("\n"))}` : ""}`;
  };
  const calls: Record<string, (...given: never[]) => unknown> = {
    beginPath: () => {
      path = [];
    },
    clearRect: () => void log.splice(0),
    fill: (given: unknown) => paint(`fill ${state.fillStyle}`, outline(given)),
    stroke: (given: unknown) => paint(pen(), outline(given)),
    fillRect: (...box: number[]) => paint(`fill ${state.fillStyle}`, [`rect${box.map(round).join(",")}`]),
    strokeRect: (...box: number[]) => paint(pen(), [`rect${box.map(round).join(",")}`]),
    fillText: (text: string, x: number, y: number) =>
      write("text", JSON.stringify(text), `${round(x)},${round(y)}`, state.fillStyle, state.textAlign, state.font),
    // The halo of a text, which is written next.
    strokeText: () => {},
    measureText: (text: string) => ({ width: text.length * letterWidth(String(state.font)) }),
    drawImage: (source: Sized, ...box: number[]) => write("picture", picture(source), "at", box.map(round).join(",")),
    putImageData: (data: ImageData, ...at: number[]) =>
      write("pixels", `${data.width}×${data.height} ${sum(data.data)}`, "at", at.map(round).join(",")),
    createImageData: (width: number, height: number) => new ImageData(width, height),
    createPattern: () => "pattern",
    createLinearGradient: () => ({ addColorStop: () => {}, toString: () => "gradient" }),
    setLineDash: (dash: number[]) => {
      state.dash = dash.length ? `dash ${dash.map(round).join(",")}` : "";
    },
    getLineDash: () => [],
    clip: (given: unknown) => {
      state.clip = shorten(outline(given));
    },
    save: () => void kept.push({ ...state, offsets: [...offsets] }),
    restore: () => {
      const { offsets: before, ...rest } = kept.pop() ?? START;
      state = rest;
      offsets.splice(0, Infinity, ...((before as string[] | undefined) ?? []));
    },
    setTransform: () => void offsets.splice(0),
    resetTransform: () => void offsets.splice(0),
    translate: (x: number, y: number) => void offsets.push(`moved ${round(x)},${round(y)}`),
    rotate: (angle: number) => void offsets.push(`turned ${Math.round((angle * 180) / Math.PI)}°`),
    scale: (x: number, y: number) => void offsets.push(`scaled ${round(x)},${round(y)}`),
    transform: (...parts: number[]) => void offsets.push(`transformed ${parts.map(round).join(",")}`),
  };
  return new Proxy(calls, {
    get: (_, name: string) => {
      if (name in COMMANDS) return (...given: unknown[]) => void path.push(command(name, given));
      if (name === "canvas") return canvas;
      if (
        !(name in calls) &&
        !(name in state) &&
        typeof name === "string" &&
        /^(fill|stroke|draw|put|create|get|is)/.test(name)
      )
        throw new Error(`the recorder of drawings has no ${name}`);
      return calls[name] ?? state[name];
    },
    set: (_, name: string, value) => {
      state[name] = value;
      return true;
    },
  });
}
