import type { LayerAbout } from "../path/layers.ts";
import { decodePose } from "../path/path.ts";
import type { TimedFrame } from "../player/segments.ts";
import { decodeScan } from "../shared/frames/scan.ts";
import { decodeSpeeds, STEERING } from "../shared/frames/speeds.ts";
import { decodeTouch } from "../shared/frames/touch.ts";

const AXES = ["linear_x", "linear_y", "linear_z", "angular_x", "angular_y", "angular_z"];
/** Bytes of a frame before the stamp of its sample, and of a speed before the stamp of its command. */
const STAMP_AT = 16;
const COMMAND_STAMP_AT = 48;

type Table = { head: string[]; rows: (string | number)[][] };

/** By widget, the values of its frames; other widgets have no CSV. */
const TABLES: Record<string, (frames: DataView[], layers: LayerAbout[], role?: string) => Table> = {
  laser_widget: toScans,
  path_widget: toPoses,
  speed_widget: (frames, _, role) => toSpeeds(frames, role),
  touch_widget: toTouches,
};

export function hasTable(widget: string): boolean {
  return widget in TABLES;
}

/**
 * Samples of a topic as CSV, with seconds from the start of the recording and the stamp in ns, or 0 if there is no
 * stamp.
 * @param layers the layers of a map
 * @param role the role of the samples, for frames that have several
 */
export function toCsv(widget: string, frames: TimedFrame[], layers: LayerAbout[] = [], role?: string): string {
  const stampAt = role === "commanded" ? COMMAND_STAMP_AT : STAMP_AT;
  const bytes = frames.map((frame) => frame.bytes);
  const { head, rows } = TABLES[widget]?.(bytes, layers, role) ?? { head: [], rows: [] };
  const lines = rows.map((row, i) => {
    const { time, bytes } = frames[i] as TimedFrame;
    return [String(time), String(bytes.getBigInt64(stampAt, true)), ...row].join();
  });
  return `${[["seconds", "stamp_ns", ...head].map(quoted).join(), ...lines].join("\n")}\n`;
}

function toScans(frames: DataView[]): Table {
  const scans = frames.map(decodeScan);
  const rays = scans.reduce((most, { count }) => Math.max(most, count), 0);
  const lit = scans.some(({ intensities }) => intensities.length);
  const names = (of: string) => Array.from({ length: rays }, (_, i) => `${of}[${i}]`);
  const limits = ["angle_min", "angle_increment", "range_min", "range_max"];
  return {
    head: [...limits, ...names("ranges"), ...(lit ? names("intensities") : [])],
    rows: scans.map(({ angleMin, angleIncrement, minRange, maxRange, ranges, intensities }) => {
      const padded = (values: Float32Array) => Array.from({ length: rays }, (_, i) => toShortest(values[i]));
      const numbers = [angleMin, angleIncrement, minRange, maxRange];
      return [...numbers, ...padded(ranges), ...(lit ? padded(intensities) : [])];
    }),
  };
}

/**
 * The poses of odometry; for a map, the poses of each of its layers in its frame, each with the time of its message.
 */
function toPoses(frames: DataView[], layers: LayerAbout[]): Table {
  const poses = frames.map(decodePose);
  if (!layers.length) return { head: ["x", "y", "yaw"], rows: poses.map(({ x, y, yaw }) => [x, y, yaw].map(toText)) };
  const placed = layers.filter(({ kind }) => kind === "pose" || kind === "goal");
  const rows = poses.map((pose) =>
    placed.flatMap(({ number }) => {
      const { time, x, y, yaw } = pose.layers.find((one) => one.number === number) ?? {};
      return [time, x, y, yaw].map(toText);
    }),
  );
  return { head: placed.flatMap(({ name }) => ["seconds", "x", "y", "yaw"].map((part) => `${name} ${part}`)), rows };
}

function toSpeeds(frames: DataView[], role?: string): Table {
  const speeds = frames.map(decodeSpeeds);
  const has = { measured: speeds.some((s) => s.measured), commanded: speeds.some((s) => s.commanded) };
  const kinds = (["measured", "commanded"] as const).filter((kind) => has[kind] && kind === (role ?? kind));
  const isSteered = speeds.some((speed) => kinds.some((kind) => !Number.isNaN(speed[kind]?.[STEERING] ?? NaN)));
  const axes = isSteered ? [...AXES, "steering"] : AXES;
  return {
    head: kinds.flatMap((kind) => axes.map((axis) => `${kind}_${axis}`)),
    rows: speeds.map((speed) => kinds.flatMap((kind) => axes.map((_, i) => toText(speed[kind]?.[i])))),
  };
}

function toTouches(frames: DataView[]): Table {
  const touches = frames.map(decodeTouch);
  const names = [...new Set(touches.flatMap(({ sensors }) => sensors.map(({ name }) => name)))];
  return {
    head: names,
    rows: touches.map(({ sensors }) => names.map((name) => sensors.find((s) => s.name === name)?.state ?? "unknown")),
  };
}

/** The shortest decimal number that is nearest to this float32: exact when it is read as float32. */
function toShortest(value: number | undefined): string {
  if (value === undefined || !Number.isFinite(value)) return toText(value);
  for (let digits = 6; digits < 9; digits++) {
    const short = Number(value.toPrecision(digits));
    if (Math.fround(short) === value) return String(short);
  }
  return value.toPrecision(9);
}

/** A number as other programs read it, or "" if it is missing. */
function toText(value: number | undefined): string {
  if (value === undefined) return "";
  if (Number.isNaN(value)) return "nan";
  return Number.isFinite(value) ? String(value) : value > 0 ? "inf" : "-inf";
}

function quoted(text: string): string {
  // A spreadsheet takes a text that begins like this for a formula.
  const harmless = /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  return /[",\n\r]/.test(harmless) ? `"${harmless.replaceAll('"', '""')}"` : harmless;
}
