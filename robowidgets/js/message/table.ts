import { toCount, toMany } from "../shared/format.ts";
import { nameOf, toExact, toReadable, toSaid, toText } from "./text.ts";
import { elementsOf, type Field, find, summaryOf, textsOf, toNumber } from "./tree.ts";

/** A bar behind a number, from one end to another. */
export interface Bar {
  low: number;
  high: number;
  value: number;
  /** Start of the bar: 0 if that is within the ends, else the lower end. */
  from: number;
  /** Texts at the ends, or "". */
  ends: [string, string];
}

export interface Cell {
  text: string;
  unit: string;
  more: string;
  isNone: boolean;
  bar: Bar | null;
}

export interface TableRow {
  /** The path of its field. */
  key: string;
  name: string;
  /** Its index in the arrays, or "" if it is not an element. */
  index: string;
  cells: Cell[];
  /** More values, shown when the row is unfolded. */
  inner: [name: string, value: string][];
  /** Level of a diagnostic, by the numbers of its definition. */
  level: number | null;
}

export interface Table {
  kind: "joints" | "battery" | "diagnostics";
  heads: { name: string; unit: string }[];
  rows: TableRow[];
  /** A line below the rows. */
  note: string;
}

/** The least and the greatest value that a page has seen of each number. */
export class Seen {
  readonly #ends = new Map<string, [number, number]>();

  /** The ends with one more value. */
  with(key: string, value: number): [low: number, high: number] {
    const ends = this.#ends.get(key) ?? [value, value];
    if (Number.isFinite(value)) {
      ends[0] = Math.min(ends[0], value);
      ends[1] = Math.max(ends[1], value);
      this.#ends.set(key, ends);
    }
    return ends;
  }
}

/** Rows with bars for a message that they show better than a tree; null for any other. */
export function toTable(fields: readonly Field[], seen: Seen): Table | null {
  const by = new Map(fields.map((field) => [field.node.name, field]));
  const has = (...names: string[]) => names.every((name) => by.has(name));
  if (has("name", "position", "velocity", "effort") && by.get("name")?.node.kind !== "text") return toJoints(by, seen);
  if (has("voltage", "percentage", "power_supply_status")) return toBattery(by, seen);
  const status = by.get("status");
  const [first] = status?.children ?? [];
  if (status?.node.kind === "messages" && first && find(first.children ?? [], `${first.path}.level`)) {
    return toDiagnostics(status);
  }
  return null;
}

const JOINT_COLUMNS = [
  ["position", "rad, m"],
  ["velocity", "rad/s, m/s"],
  ["effort", "N\u00b7m, N"],
] as const;

function toJoints(by: Map<string, Field>, seen: Seen): Table {
  const names = by.get("name") as Field;
  const texts = names.node.kind === "texts" ? textsOf(names) : [];
  const columns = JOINT_COLUMNS.map(([name]) => {
    const field = by.get(name) as Field;
    return field.node.kind === "numbers" ? elementsOf(field, 0, summaryOf(field).count) : [];
  });
  // Without names, joints go by their index.
  const count = Math.max(texts.length, ...columns.map((column) => column.length));
  const rows = Array.from({ length: count }, (_, i): TableRow => {
    const value = texts[i]?.value ?? "";
    const cells = columns.map((column, c) => {
      const field = column[i];
      const head = JOINT_COLUMNS[c]?.[0];
      if (!field) return { text: "\u2014", unit: "", more: "", isNone: true, bar: null };
      const number = toNumber(field.value);
      if (Number.isNaN(number)) return { text: "\u2014", unit: "", more: "", isNone: true, bar: null };
      const [low, high] = seen.with(`${head} ${toText(value) || i}`, number);
      const text = toReadable(field.value, field.node.type, 4);
      // Beyond a full turn it is a wheel.
      const turns = head === "position" && Math.max(-low, high) > 2 * Math.PI ? number / (2 * Math.PI) : null;
      if (turns !== null)
        return { text, unit: "", more: `${turns.toFixed(1).replace("-", "\u2212")} turns`, isNone: false, bar: null };
      return { text, unit: "", more: "", isNone: false, bar: toBar(number, low, high) };
    });
    return { key: `name[${i}]`, name: toText(value), index: `[${i}]`, cells, inner: [], level: null };
  });
  const left = (names.value as [number])[0] - rows.length;
  const cells = rows.flatMap((row) => row.cells);
  const notes = [
    left > 0 ? `${toCount(left)} more joints in the tree.` : "",
    cells.some(({ bar }) => bar) ? "Bars go from the least to the greatest that this page has seen." : "",
    cells.some(({ isNone }) => isNone) ? "\u2014 is not measured (NaN), or not sent." : "",
  ];
  const note = notes.filter(Boolean).join(" ");
  return { kind: "joints", heads: JOINT_COLUMNS.map(([name, unit]) => ({ name, unit })), rows, note };
}

function toBar(value: number, low: number, high: number, ends: [string, string] = ["", ""]): Bar | null {
  if (!(high > low) || !Number.isFinite(value)) return null;
  return { low, high, value, from: low <= 0 && high >= 0 ? 0 : low, ends };
}

const ENUMS = ["power_supply_status", "power_supply_health", "power_supply_technology", "present"];

function toBattery(by: Map<string, Field>, seen: Seen): Table {
  const row = (name: string, cell: Partial<Cell>, index = ""): TableRow => {
    const cells = [{ text: "", unit: "", more: "", isNone: false, bar: null, ...cell }];
    return { key: index ? `${name}${index}` : name, name: index ? "" : name, index, cells, inner: [], level: null };
  };
  const rows: TableRow[] = [];
  const read = (name: string) => toNumber(by.get(name)?.value ?? null);
  for (const name of ["percentage", "voltage", "current", "charge", "capacity", "design_capacity", "temperature"]) {
    const field = by.get(name);
    if (!field) continue;
    const said = toSaid(field);
    const number = toNumber(field.value);
    if (said.isNone || !Number.isFinite(number)) rows.push(row(name, { ...said, bar: null }));
    else if (name === "percentage") {
      const text = String(Number((100 * number).toFixed(1))).replace("-", "\u2212");
      const more = `${toExact(field.value, field.node.type)} in the message`;
      rows.push(row(name, { text, unit: "%", more, bar: toBar(Math.min(100, 100 * number), 0, 100, ["0", "100"]) }));
    } else if (name === "charge" && read("capacity") > 0) {
      const capacity = read("capacity");
      const ends: [string, string] = ["0", `${toReadable(capacity, "float32")} capacity`];
      rows.push(row(name, { ...said, bar: toBar(Math.min(number, capacity), 0, capacity, ends) }));
    } else if (name === "current") {
      const [low, high] = seen.with(name, number);
      const ends: [string, string] = [toReadable(low, "float32", 3), `${toReadable(high, "float32", 3)} seen`];
      rows.push(row(name, { ...said, bar: toBar(number, low, high, ends) }));
    } else rows.push(row(name, said));
  }
  for (const name of ENUMS) {
    const field = by.get(name);
    if (field) rows.push(row(name, toSaid(field)));
  }
  const cells = by.get("cell_voltage");
  if (cells?.node.kind === "numbers") {
    rows.push(row("cell_voltage", toSaid(cells)));
    const each = elementsOf(cells, 0, summaryOf(cells).count);
    const most = Math.max(0, ...each.map(({ value }) => toNumber(value)).filter(Number.isFinite));
    for (const field of each) {
      const bar = toBar(toNumber(field.value), 0, most);
      rows.push(row("cell_voltage", { ...toSaid(field), bar }, field.node.name));
    }
  }
  return { kind: "battery", heads: [], rows, note: "" };
}

function toDiagnostics(status: Field): Table {
  const rows = (status.children ?? []).map((one): TableRow => {
    const own = (name: string) => one.children?.find(({ node }) => node.name === name);
    const level = own("level");
    const word = level ? nameOf(level.value, level.node.names) || toExact(level.value, level.node.type) : "";
    const [name, message] = [own("name"), own("message")].map((field) => (field ? toText(field.value) : ""));
    const values = own("values")?.children ?? [];
    const inner = values.map(({ children }): [string, string] => {
      const [key, value] = (children ?? []).map((field) => toText(field.value));
      return [key ?? "", value ?? ""];
    });
    const cell: Cell = { text: message ?? "", unit: "", more: word, isNone: false, bar: null };
    const number = level ? toNumber(level.value) : null;
    return { key: one.path, name: name ?? "", index: one.node.name, cells: [cell], inner, level: number };
  });
  const left = status.node.more ?? 0;
  const note = left ? `${toMany(left, "more part")}: the tree has them.` : "";
  return { kind: "diagnostics", heads: [], rows, note };
}
