/** The number of the first element for which a test holds that holds for all after it; the length where for none. */
export function firstWhere(values: ArrayLike<number>, test: (value: number) => boolean): number {
  let [low, high] = [0, values.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (test(values[middle] as number)) high = middle;
    else low = middle + 1;
  }
  return low;
}
