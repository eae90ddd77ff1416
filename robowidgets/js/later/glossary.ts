import { set } from "../shared/dom.ts";
import { on } from "../shared/events.ts";

/** Words that a student may not know, each with one sentence. */
const GLOSSARY: readonly [RegExp, string][] = [
  [
    /\[\d+\]/,
    "A number in brackets, such as [225], is an index: it counts the rays of a scan, or the elements of another array, from 0.",
  ],
  [
    /(?<![\w/])odom\b/,
    "odom is the frame that starts where the robot was switched on; positions in it drift, but never jump.",
  ],
  [/\/odom\b/, "Odometry is where the robot is and how fast it moves, as its wheels count it."],
  [/\bbase_(link|footprint)\b/, "base_link is the frame of the robot's body: x ahead, y to the left, z up."],
  [/\/cmd_vel\b/, "cmd_vel is the speed that the robot is commanded to drive."],
  [/\/tf(_static)?\b/, "tf is the tree that says where each coordinate frame is in another."],
  [/\broll\b/, "roll turns about the axis that points ahead; positive lifts the left side."],
  [/\bpitch\b/, "pitch turns about the axis that points left; positive lowers the nose."],
  [/\byaw\b/, "yaw turns about the axis that points up; positive is to the left."],
  [/\brad\b/, "rad is the unit of angles in ROS: 1 rad is 57.3\u00b0, a whole turn is 6.28 rad."],
  [/[+]inf\b|\binf\b(?<![-\u2212]inf)/, "+inf (REP 117): the beam met nothing up to range_max."],
  [/[-\u2212]inf\b/, "\u2212inf (REP 117): something is nearer than range_min."],
  [/\bnan\b/i, "NaN (REP 117): not a number, as the sensor could not measure."],
  [
    /\borientation\b|\bquaternion\b/i,
    "A quaternion is a rotation as four numbers x, y, z, w; yaw is one of the angles in it.",
  ],
  [/\btwist\b/i, "A twist is a speed: linear in m/s, and angular in rad/s."],
  [/\bcovariance\b/, "A covariance is how uncertain the values are, as a square table row by row."],
  [/\bframe_id\b/, "frame_id is the name of the coordinate frame in which the numbers are given."],
  [/\bstamp\b/, "stamp is the time of the measurement, in seconds and nanoseconds."],
  [/\bangle_increment\b/, "angle_increment is the angle from one ray to the next, in radians."],
];

/** Letters of the longest text that is looked up as a whole: longer ones are not names or numbers. */
const LONGEST = 200;

/** Sentences on the words of a text, in the order of the glossary. */
export function explain(text: string): string[] {
  return GLOSSARY.flatMap(([word, sentence]) => (word.test(text) ? [sentence] : []));
}

/** The tooltips and descriptions without the sentences that they got. */
const plain = new WeakMap<HTMLElement, { given: string; before: string }>();

/**
 * Explains the words of the cards of a page: in the tooltip of the text under the pointer, and, for screen readers, in
 * the description of the part that has the focus. Nothing is looked up before.
 */
export function explainWords(page: Document): void {
  const signal = new AbortController().signal;
  on(page, "pointerover", (event) => explainOn(innermost(event), "title", explainTip), signal);
  on(page, "focusin", (event) => explainOn(innermost(event), "ariaDescription", explainCard), signal);
}

/** The element of an event, in shadow roots too. */
function innermost(event: Event): EventTarget | undefined {
  return event.composedPath()[0];
}

function explainOn(
  target: EventTarget | undefined,
  name: "title" | "ariaDescription",
  look: (element: HTMLElement, before: string) => string,
): void {
  if (!(target instanceof HTMLElement) || !target.closest(".rw-card")) return;
  const known = plain.get(target);
  const now = target[name] ?? "";
  // What stands there may be ours, of another text.
  const before = known?.given === now ? known.before : now;
  const given = look(target, before);
  if (given === now) return;
  plain.set(target, { given, before });
  set(target, name, given);
}

/** The tooltip of a text with the sentences on it, after its own or the one of the part that it is in. */
function explainTip(element: HTMLElement, own: string): string {
  if (element.childElementCount) return own;
  const outer = own || element.parentElement?.closest<HTMLElement>("[title]")?.title || "";
  const text = `${element.textContent} ${outer}`;
  const sentences = text.length > LONGEST ? [] : explain(text);
  return sentences.length ? [outer, ...sentences].filter(Boolean).join("\n") : own;
}

/** The description of a picture, with the sentences on all words of its card. */
function explainCard(element: HTMLElement, own: string): string {
  const card = element.closest(".rw-card");
  if (!card || !element.matches(".rw-picture, .rw-card")) return own;
  const words = [...card.querySelectorAll<HTMLElement>("*")].filter(
    (inner) => !inner.childElementCount && inner.offsetWidth > 0,
  );
  const sentences = new Set(words.flatMap(({ textContent }) => explain((textContent ?? "").slice(0, LONGEST))));
  return [own, ...sentences].filter(Boolean).join(" ");
}
