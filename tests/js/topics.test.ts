import assert from "node:assert/strict";
import { test } from "node:test";
import { toFewWords } from "../../robowidgets/js/topics/groups.ts";

test("a row shows the first number or word of a topic's value, without the names before it", () => {
  const said = {
    "nearest 0.8 m, 357 rays": "0.8 m",
    "no reading, 357 rays": "no reading",
    "0.509 m/s, 0.08 rad/s": "0.509 m/s",
    "pose.pose.position.x −6.1, pose.pose.position.y 2": "x −6.1",
    "voltage 16.21, present true": "voltage 16.21",
    '"agent: 1, at rest"': "agent: 1, at rest",
    "[1, 2, 3]": "[1, 2, 3]",
    "nothing touched": "nothing touched",
    "nothing yet": "–",
    "180": "180",
    "": "",
  };
  for (const [all, few] of Object.entries(said)) assert.equal(toFewWords(all), few);
});
