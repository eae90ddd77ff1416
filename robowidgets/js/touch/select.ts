import type { Sensor } from "../shared/frames/touch.ts";

/**
 * The sensors of these names, in their order, UNKNOWN for sensors without a message. Without names, all sensors; those
 * that differ only in the side in their names are sorted from left to right.
 */
export function select(sensors: Sensor[], names: string[]): Sensor[] {
  if (names.length === 0) return fromLeftToRight(sensors);
  const known = new Map(sensors.map((sensor) => [sensor.name, sensor]));
  return names.map((name) => known.get(name) ?? { name, state: "unknown", touches: 0, seconds: null });
}

const SIDES = /left|right|cent(?:er|re)|middle/i;

/** Each group keeps its places among the others. */
function fromLeftToRight(sensors: Sensor[]): Sensor[] {
  const waiting = new Map<string, Sensor[]>();
  for (const sensor of sensors) {
    const { group } = sideOf(sensor);
    waiting.set(
      group,
      [...(waiting.get(group) ?? []), sensor].sort((a, b) => sideOf(a).rank - sideOf(b).rank),
    );
  }
  return sensors.map((sensor) => waiting.get(sideOf(sensor).group)?.shift() ?? sensor);
}

/** The rank of a sensor from left to right, and its name without its side; a name without a side is a group alone. */
function sideOf({ name }: Sensor): { rank: number; group: string } {
  const side = SIDES.exec(name)?.[0].toLowerCase();
  if (!side) return { rank: 0, group: `=${name}` };
  return { rank: side === "left" ? 0 : side === "right" ? 2 : 1, group: name.replace(SIDES, "") };
}
