import assert from "node:assert/strict";
import { test } from "node:test";
import { layOut } from "../../robowidgets/js/scanogram/layout.ts";
import {
  cutName,
  drawStates,
  machineOf,
  nameOf,
  type StateSpan,
  stateAt,
  statesAt,
  toWords,
} from "../../robowidgets/js/shared/states/states.ts";
import type { Theme } from "../../robowidgets/js/shared/theme.ts";

const OUTER: StateSpan[] = [
  [0, 4, "Walker.forward"],
  [4, 7, "Walker.avoid"],
  [7, 10, "Walker.forward"],
];
const INNER: StateSpan[] = [
  [4, 5, "Walker.avoid.stop"],
  [5, 7, "Walker.avoid.turn"],
];
const THEME = { dark: false, ink: "ink", background: "white", font: "sans" } as Theme;

/** A canvas that records fills and texts; each character is 6 pixels wide. */
function sheet() {
  const filled: [string, number, number][] = [];
  const written: string[] = [];
  const context = {
    fillStyle: "",
    measureText: (text: string) => ({ width: 6 * text.length }),
    fillRect(x: number, _y: number, width: number) {
      filled.push([this.fillStyle, x, width]);
    },
    fillText: (text: string) => written.push(text),
  };
  return { context: context as unknown as CanvasRenderingContext2D, filled, written };
}

test("a state is active from its start up to its end, and the last one at the end of all", () => {
  assert.equal(stateAt(OUTER, 3.99)?.[2], "Walker.forward");
  assert.equal(stateAt(OUTER, 4)?.[2], "Walker.avoid");
  assert.equal(stateAt(OUTER, 10)?.[0], 7);
  assert.equal(stateAt(OUTER, 10.1), null);
  assert.equal(stateAt(INNER, 3), null);
  const active = statesAt([OUTER, INNER], 5.5).map(([, , path]) => path);
  assert.deepEqual(active, ["Walker.avoid", "Walker.avoid.turn"]);
});

test("a state is named by its last part, a row by the machine that all of it belongs to", () => {
  assert.equal(nameOf("Walker.avoid.turn"), "turn");
  assert.equal(nameOf("forward"), "forward");
  assert.equal(toWords("Walker.avoid.turn"), "Walker \u203a avoid \u203a turn");
  assert.equal(machineOf(OUTER), "Walker");
  assert.equal(machineOf(INNER), "avoid");
  assert.equal(machineOf([...OUTER, ...INNER]), "");
});

test("a name too long for its span is cut, and left out if two letters would remain", () => {
  const { context } = sheet();
  assert.equal(cutName(context, "forward", 42, THEME), "forward");
  assert.equal(cutName(context, "forward", 41, THEME), "forwa\u2026");
  assert.equal(cutName(context, "forward", 31, THEME), "");
  assert.equal(cutName(context, "a", 5, THEME), "");
});

test("each state keeps a different gray, and states out of view are not drawn", () => {
  globalThis.matchMedia = () => ({ matches: false }) as MediaQueryList;
  const { context, filled, written } = sheet();
  const tones = new Map();
  drawStates(context, { span: [3, 10], left: 10, width: 700 }, 0, OUTER, tones, THEME);
  assert.deepEqual(filled, [
    ["#e6eaee", 10, 99],
    ["#c9d1da", 110, 299],
    ["#e6eaee", 410, 299],
  ]);
  assert.deepEqual(written, ["forward", "avoid", "forward"]);
  drawStates(context, { span: [5, 6], left: 10, width: 700 }, 0, OUTER.slice(1), tones, THEME);
  assert.deepEqual(filled.slice(3), [["#c9d1da", 10, 699]]);
  drawStates(context, { span: [4, 7], left: 10, width: 700 }, 0, INNER, tones, THEME);
  assert.equal(filled[4]?.[0], "#e6eaee", "the first state of another machine");
});

test("rows of states stand at the foot of the picture, one below the other, and the scans give way", () => {
  const without = layOut({ width: 800, height: 400 }, null, 0);
  const { states, scans, bottom } = layOut({ width: 800, height: 400 }, null, 0, 3);
  assert.deepEqual(
    states.map(({ top, height }) => top + height),
    [bottom - 34, bottom - 17, bottom],
  );
  assert.ok(scans.top + scans.height < (states[0]?.top ?? 0));
  assert.equal(without.scans.height - scans.height, 56);
});
