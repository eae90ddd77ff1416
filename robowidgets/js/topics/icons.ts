import { makeSvg } from "../shared/dom.ts";

/** Paths in 14 by 14, by words in the short type; the first that fits. */
const ICONS: [RegExp, string][] = [
  [/^LaserScan|MultiEcho/, "M2 5a7 7 0 0 1 10 0L7 11z"],
  [/Odometry/, "M3 11V6M7 11V3M11 11V8"],
  [/^Twist|Ackermann|Accel/, "M2 7h9M8 4l3 3-3 3"],
  [/Bumper|Hazard|Contact|Cliff|Touch/, "M2 5.5a2 2 0 0 1 2-2h6a2 2 0 0 1 2 2v3a2 2 0 0 1-2 2H4a2 2 0 0 1-2-2z"],
  [/^Range/, "M4 3h6L7 11z"],
  [/Imu|Magnetic/, "M7 7V2M7 7l-4 4M7 7l4 4"],
  [/Battery/, "M2 4.5h8v5H2zM11.5 6v2"],
  [/Joint/, "M4 10l5-5M3 12a1.5 1.5 0 1 0 0-.1M10 4a1.5 1.5 0 1 0 0-.1"],
  [/Pose|Point$|PointStamped|NavSat/, "M7 2l4 9-4-2-4 2z"],
  [/Path$/, "M2 11c3 0 2-4 5-4s2-4 5-4"],
  [/Grid|Costmap|Map/, "M2 2h10v10H2zM7 2v10M2 7h10"],
  [/TF|Transform/, "M7 2v4M3 11V7h8v4"],
  [/Image|Camera/, "M2 3h10v8H2zM3 10l3-3 2 2 1.5-1.5L12 10"],
  [/PointCloud/, "M3 4h.1M7 3h.1M11 5h.1M5 7h.1M9 8h.1M3 10h.1M7 11h.1M11 11h.1"],
  [/Diagnostic/, "M2 7l3 4 7-8"],
  [/Log|String|Event/, "M2 3.5h10M2 7h10M2 10.5h6"],
  [/State/, "M5 3L2 7l3 4M9 3l3 4-3 4"],
  [/Joy/, "M4 5h6a3 3 0 0 1 0 6L8 9H6l-2 2a3 3 0 0 1 0-6"],
];
const OTHER =
  "M4 2c-1 0-1.5.5-1.5 1.5v2C2.5 6.5 2 7 1.5 7c.5 0 1 .5 1 1.5v2C2.5 11.5 3 12 4 12M10 2c1 0 1.5.5 1.5 1.5v2c0 1 .5 1.5 1 1.5-.5 0-1 .5-1 1.5v2c0 1-.5 1.5-1.5 1.5";

/** The icon of a type, in the colour of the text. */
export function makeTypeIcon(shortType: string): SVGElement {
  const icon = makeSvg("svg", { viewBox: "0 0 14 14", class: "rw-topic-icon", "aria-hidden": "true" });
  const d = ICONS.find(([words]) => words.test(shortType))?.[1] ?? OTHER;
  icon.append(makeSvg("path", { d }));
  return icon;
}
