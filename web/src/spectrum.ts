// Amplitude spectrum of a signal that was sampled at a constant rate.

/** In place; as many values as a power of two. Cooley and Tukey's, radix 2. */
export function fft(re: Float64Array, im: Float64Array): void {
  const n = re.length;
  for (let i = 1, j = 0; i < n; ++i) {
    let bit = n >> 1;
    for (; (j & bit) !== 0; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) {
      [re[i], re[j]] = [re[j]!, re[i]!];
      [im[i], im[j]] = [im[j]!, im[i]!];
    }
  }
  for (let size = 2; size <= n; size *= 2) {
    const half = size / 2;
    for (let k = 0; k < half; ++k) {
      const c = Math.cos((2 * Math.PI * k) / size);
      const s = -Math.sin((2 * Math.PI * k) / size);
      for (let a = k; a < n; a += size) {
        const b = a + half;
        const tr = re[b]! * c - im[b]! * s;
        const ti = re[b]! * s + im[b]! * c;
        re[b] = re[a]! - tr;
        im[b] = im[a]! - ti;
        re[a] = re[a]! + tr;
        im[a] = im[a]! + ti;
      }
    }
  }
}

export interface Peak {
  hz: number;
  amplitude: number;
}

export interface Spectrum {
  hz: number[];
  amplitude: number[];
  /** The greatest one, between its two bins; null: the signal stands still. */
  peak: Peak | null;
}

/** Most values that may be missing: late ticks leave a column empty. */
const kMostMissing = 0.1;

/** Missing values (NaN) on a straight line between their neighbours; null: too many. */
export function filled(values: ArrayLike<number>): Float64Array | null {
  const out = Float64Array.from(values);
  let last = -1;
  let missing = 0;
  for (let i = 0; i < out.length; ++i) {
    if (Number.isNaN(out[i]!)) {
      ++missing;
      continue;
    }
    for (let k = last + 1; k < i; ++k)
      out[k] = last < 0 ? out[i]! : out[last]! + ((out[i]! - out[last]!) * (k - last)) / (i - last);
    last = i;
  }
  if (last < 0 || missing > kMostMissing * out.length) return null;
  out.fill(out[last]!, last + 1);
  return out;
}

/**
 * Amplitudes in the signal's unit (of a sine its peak value, not peak to peak), without its mean, through a Hann window.
 * As many values as a power of two, NaN: missing. Null: too many are.
 */
export function spectrumOf(values: ArrayLike<number>, rate_hz: number): Spectrum | null {
  const re = filled(values);
  if (re === null) return null;
  const n = re.length;
  const mean = re.reduce((sum, value) => sum + value, 0) / n;
  // The window's mean is 1/2, and a sine is in two bins.
  for (let i = 0; i < n; ++i) re[i] = ((re[i]! - mean) * (1 - Math.cos((2 * Math.PI * i) / n)) * 2) / n;
  const im = new Float64Array(n);
  fft(re, im);
  const amplitude = Array.from({ length: n / 2 }, (_, k) => Math.hypot(re[k]!, im[k]!));
  const hz = amplitude.map((_, k) => (k * rate_hz) / n);
  return { hz, amplitude, peak: peakOf(amplitude, rate_hz / n) };
}

// Between the bins a sine is where the ratio of both neighbours says, exactly so with a Hann window.
function peakOf(amplitude: number[], step_hz: number): Peak | null {
  let k = 1;
  for (let i = 1; i < amplitude.length; ++i) if (amplitude[i]! > amplitude[k]!) k = i;
  const here = amplitude[k] ?? 0;
  if (here < 1e-9) return null;
  const before = k > 1 ? amplitude[k - 1]! : 0;
  const after = amplitude[k + 1] ?? 0;
  const ratio = Math.max(before, after) / here;
  const offset = Math.max(0, (2 * ratio - 1) / (ratio + 1));
  const lobe = offset === 0 ? 1 : Math.sin(Math.PI * offset) / (Math.PI * offset) / (1 - offset * offset);
  return { hz: (k + (after > before ? offset : -offset)) * step_hz, amplitude: here / lobe };
}
