import assert from "node:assert/strict";
import { test } from "node:test";
import { angleFormula } from "../../robowidgets/js/laser/formula.ts";

const plain = (text: string) => text.replaceAll("\u2212", "-").replaceAll("\u00A0", " ");

/** The result of a calculator for the numbers of a formula. */
function calculate(numbers: string): number {
  const [first = "", index = "", step = "", offset = "0"] =
    plain(numbers)
      .match(/^(-?[\d.]+) \+ (\d+) × \(?(-?[\d.]+)\)?(?: ([+-] [\d.]+))?$/)
      ?.slice(1) ?? [];
  assert.notEqual(step, "", numbers);
  return Number(first) + Number(index) * Number(step) + Number(offset.replace(" ", ""));
}

const sweep = (angleMin: number, angleIncrement: number, count = 2000) => ({ angleMin, angleIncrement, count });

test("the formula of a ray has names, numbers and result", () => {
  const formula = angleFormula(sweep(-2.356194496154785, 0.004097729921340942), 718);
  assert.equal(plain(formula.names), "angle_min + 718 × increment");
  assert.equal(plain(formula.numbers), "-2.35619 + 718 × 0.00409773");
  assert.equal(plain(formula.radians), "0.58598 rad");
  assert.equal(formula.degrees, "33.57°");
  assert.equal(formula.wrapped, "");
});

test("a calculator gives the result on show, for any scanner", () => {
  const steps = [0.004363323, -0.0061359233, 0.017453292, 0.0174533, 0.00869044, 1e-5, 2.5, 0];
  for (const angleMin of [-2.3561945, 0, -Math.PI, 3.2, -0.5, 1e-7, -1e-7]) {
    for (const step of steps.map(Math.fround)) {
      for (const index of [0, 1, 7, 99, 635, 1039, 19_999]) {
        for (const offset of [0, 0.35, -Math.PI / 2]) {
          const { numbers, radians, degrees } = angleFormula(
            sweep(Math.fround(angleMin) + offset, step),
            index,
            offset,
          );
          const shown = Number.parseFloat(plain(radians));
          const result = calculate(numbers);
          const digits = plain(radians).match(/\.(\d+)/)?.[1]?.length ?? 0;
          assert.equal(Number(result.toFixed(digits)), shown, `${numbers} = ${radians}`);
          assert.equal(Number(((shown * 180) / Math.PI).toFixed(2)), Number.parseFloat(plain(degrees)), radians);
          assert.ok(numbers.length < 50, numbers);
        }
      }
    }
  }
});

test("round numbers stay short, a negative increment stands in brackets, and an offset is a term", () => {
  assert.equal(plain(angleFormula(sweep(0.5, -0.25), 3).numbers), "0.5 + 3 × (-0.25)");
  const turned = angleFormula(sweep(-0.5 - 0.25, 0.5), 2, -0.25);
  assert.equal(plain(turned.names), "angle_min + 2 × increment + angle_offset");
  assert.equal(plain(turned.numbers), "-0.5 + 2 × 0.5 - 0.25");
  assert.equal(plain(turned.radians), "0.25000 rad");
});

test("the angle of the robot is calculated from the scanner's angle, also upside down, and that angle alone has a formula, too", () => {
  const mount = { yaw: 1.5, words: "" };
  const upright = angleFormula(sweep(-0.5 + 1.5, 0.25), 3, 0, mount);
  assert.equal(plain(upright.names), "angle_min + 3 × increment + yaw");
  assert.equal(plain(upright.numbers), "-0.5 + 3 × 0.25 + 1.5");
  assert.equal(plain(upright.radians), "1.75000 rad");
  const hanging = angleFormula(sweep(1.5 + 0.5, -0.25), 3, 0, { ...mount, upside_down: true });
  assert.equal(plain(hanging.names), "yaw - (angle_min + 3 × increment)");
  assert.equal(plain(hanging.numbers), "1.5 - (-0.5 + 3 × 0.25)");
  assert.equal(plain(hanging.radians), "1.25000 rad");
  const own = angleFormula(sweep(1.5 + 0.5 + 0.1, -0.25), 3, 0.1, { ...mount, upside_down: true }, true);
  assert.deepEqual([own.names, own.numbers, own.radians].map(plain), [
    "angle_min + 3 × increment",
    "-0.5 + 3 × 0.25",
    "0.25000 rad",
  ]);
});

test("beyond half a turn the formula has the angle of the label", () => {
  const last = angleFormula(sweep(0, Math.PI / 180), 359);
  assert.equal(last.degrees, "359.00°");
  assert.equal(plain(last.wrapped), "359.00° - 360° = -1.00°");
  assert.equal(plain(angleFormula(sweep(0, -Math.PI / 180), 200).wrapped), "-200.00° + 360° = 160.00°");
  assert.equal(angleFormula(sweep(-Math.PI, Math.PI / 180), 360).wrapped, "");
});

test("a line breaks only in front of operators", () => {
  const { names, numbers } = angleFormula(sweep(-2.3, 0.004), 718);
  assert.deepEqual(names.split(" "), ["angle_min", "+\u00A0718", "×\u00A0increment"]);
  assert.deepEqual(numbers.split(" ").length, 3);
});
