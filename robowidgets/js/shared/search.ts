/**
 * Index of the first element that passes a test, in an array in which all later elements pass, too; its length if none
 * does.
 */
export function firstWhere<T>(values: ArrayLike<T>, test: (value: T) => boolean): number {
  let [low, high] = [0, values.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (test(values[middle] as T)) high = middle;
    else low = middle + 1;
  }
  return low;
}
