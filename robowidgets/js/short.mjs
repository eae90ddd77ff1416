// Functions that the bundles call in many places, under names that the build can shorten: "Math.max" is "$max" there.
export const {
  PI: $PI,
  abs: $abs,
  atan2: $atan2,
  ceil: $ceil,
  cos: $cos,
  floor: $floor,
  hypot: $hypot,
  max: $max,
  min: $min,
  round: $round,
  sign: $sign,
  sin: $sin,
} = Math;
export const { isFinite: $isFinite, isInteger: $isInteger, isNaN: $isNaN, parseInt: $parseInt } = Number;
