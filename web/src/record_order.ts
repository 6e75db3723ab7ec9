// Records by their time.

/**
 * Sorts both by `times`; those of one moment stay in their order. A merge sort that touches only where two neighbours overlap:
 * received frames have the kernel's time, shortly before their tick's, so a recording of rc10d takes some steps a record, and any
 * other order no more than log2(records) + 4 of them. Returns the steps: comparisons and moves.
 */
export function sortByTime(times: Float64Array, offsets: Uint32Array): number {
  const size = times.length;
  const spare: Spare = { times: new Float64Array(0), offsets: new Uint32Array(0) };
  let steps = 0;
  for (let width = 1; width < size; width *= 2)
    for (let low = 0; low + width < size; low += 2 * width)
      steps += merge(times, offsets, low, low + width, Math.min(low + 2 * width, size), spare);
  return steps;
}

interface Spare {
  times: Float64Array;
  offsets: Uint32Array;
}

// Two ordered neighbours, [low, middle) and [middle, high).
function merge(times: Float64Array, offsets: Uint32Array, low: number, middle: number, high: number, spare: Spare): number {
  const first = times[middle] ?? 0;
  if ((times[middle - 1] ?? 0) <= first) return 1;
  let steps = 1;
  let from = low;
  for (let end = middle; from < end; ++steps) {
    const half = (from + end) >>> 1;
    if ((times[half] ?? 0) <= first) from = half + 1;
    else end = half;
  }
  const count = middle - from;
  if (spare.times.length < count) {
    spare.times = new Float64Array(Math.max(count, 2 * spare.times.length));
    spare.offsets = new Uint32Array(spare.times.length);
  }
  spare.times.set(times.subarray(from, middle));
  spare.offsets.set(offsets.subarray(from, middle));
  let left = 0;
  let right = middle;
  for (let to = from; left < count; ++to, ++steps) {
    if (right < high && (times[right] ?? 0) < (spare.times[left] ?? 0)) {
      times[to] = times[right] ?? 0;
      offsets[to] = offsets[right++] ?? 0;
    } else {
      times[to] = spare.times[left] ?? 0;
      offsets[to] = spare.offsets[left++] ?? 0;
    }
  }
  return steps;
}
