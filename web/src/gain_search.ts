// Search of the gains of a velocity loop, as python/examples/pid_tuning.py does it.
import type { TestReport } from './motion_test';
import { kRestoreAtEnd } from './protocol';

export interface LoopGains {
  kp: number;
  ki: number;
}
export const kKp = 'velocity_pid.kp_a_per_rpm';
export const kKi = 'velocity_pid.ki_a_per_rpm_s';

// Percent of overshoot that are as bad as a second of settling.
const kPercentPerS = 50;
const kFirstFactor = 1.5;
// Below it the same step run twice differs by more.
const kLastFactor = 1.02;

/** Null: rc10d closes no velocity loop of the motor that commands amperes. */
export function loopGainsOf(values: Record<string, number>): LoopGains | null {
  const [kp, ki] = [values[kKp], values[kKi]];
  return kp === undefined || ki === undefined ? null : { kp, ki };
}

/** These gains are only tried: rc10d puts those of before back when the page is gone. */
export function triedValuesOf(gains: LoopGains): Record<string, number> {
  return { ...valuesOf(gains), ...kRestoreAtEnd };
}

export function valuesOf(gains: LoopGains): Record<string, number> {
  return { [kKp]: Number(gains.kp.toPrecision(4)), [kKi]: Number(gains.ki.toPrecision(4)) };
}

/** Badness of a step in seconds: settling, overshoot and what remains. */
export function scoreOf(step: TestReport['step'], seconds: number, size: number): number {
  if (step === null) return Infinity;
  return (step.settling_s ?? seconds) + (step.overshoot_percent ?? 0) / kPercentPerS + (seconds * Math.abs(step.steady_error ?? 0)) / Math.abs(size);
}

/** Gains around the best so far, one at a time, by ever smaller factors. `badness` null: the search is over, without a result. */
export async function searchGains(
  badness: (gains: LoopGains) => Promise<number | null>,
  start: LoopGains,
  tries: number,
): Promise<{ gains: LoopGains; score: number } | null> {
  const first = await badness(start);
  if (first === null) return null;
  let best = { gains: start, score: first };
  let left = tries - 1;
  let factor = kFirstFactor;
  while (left > 0 && factor > kLastFactor) {
    let improved = false;
    for (const name of ['kp', 'ki'] as const) {
      for (const scale of [factor, 1 / factor]) {
        if (left-- <= 0) break;
        const gains = { ...best.gains, [name]: best.gains[name] * scale };
        const score = await badness(gains);
        if (score === null) return null;
        if (score >= best.score) continue;
        best = { gains, score };
        improved = true;
        break;
      }
    }
    if (!improved) factor = Math.sqrt(factor);
  }
  return best;
}
