// Two pulses of current, and the acceleration of the motor by each ampere that follows from them.
import { useEffect, useRef, useState } from 'preact/hooks';

import { CopyLines } from './action';
import { useStoredOfRobot, useStudio } from './context';
import type { Link, TestOutcome } from './link';
import { type TestPlan, kFirstPlan, testCommand } from './motion_test';
import { NumberField, OptionalField } from './number_field';

/** `isKept`: among the results. */
export type Run = (plan: TestPlan, isKept?: boolean) => Promise<TestOutcome>;

/** Whether the part was left, or Escape pressed, since this was false: between two tests none is there to be ended. */
export function useEnded(): { current: boolean } {
  const ended = useRef(false);
  useEffect(() => {
    const end = () => {
      ended.current = true;
    };
    const key = (event: KeyboardEvent) => event.key === 'Escape' && end();
    const hidden = () => document.hidden && end();
    window.addEventListener('keydown', key);
    document.addEventListener('visibilitychange', hidden);
    return () => {
      end();
      window.removeEventListener('keydown', key);
      document.removeEventListener('visibilitychange', hidden);
    };
  }, []);
  return ended;
}

// The lease of a hold lasts 150 ms: an older state may say that nobody commands it.
const kLeasePauses = 4;
const pause = () => new Promise((resolve) => setTimeout(resolve, 50));

/** Until it stands, or 2 s are over, and nobody commands it: the next test begins from rest, and with its own lease. */
export async function stop(link: Link, motor: string): Promise<void> {
  const now = () => link.known.state?.data.motors.find((each) => each.name === motor);
  const held = link.hold({ motor, mode: 'velocity', value: 0 }, () => {});
  for (let i = 0; i < 40; ++i) {
    await pause();
    if (document.hidden || !held.renew() || Math.abs(now()?.velocity_rpm ?? 0) < 1) break;
  }
  held.release();
  for (let i = 0; i < 40 && (i < kLeasePauses || now()?.owner !== ''); ++i) await pause();
}

export interface Pulses {
  current_a: number;
  max_speed_rpm: number | null;
  time_constant_s: number;
}
const kFirstPulses: Pulses = { current_a: 1, max_speed_rpm: null, time_constant_s: 0.03 };

export interface Measurement {
  pulses: Pulses;
  set: (part: Partial<Pulses>) => void;
  /** The first pulse, or the second one, as a test. */
  pulse: (which: 1 | 2) => TestPlan;
  measuring: boolean;
  /** Acceleration in rpm/s by each ampere; null: it ended early, and the test says why. */
  measure: () => Promise<number | null>;
}

export function useMeasurement(motor: string, plan: TestPlan, run: Run): Measurement {
  const { link } = useStudio();
  const [pulses, setPulses] = useStoredOfRobot(`proposal/${motor}`, kFirstPulses);
  const [measuring, setMeasuring] = useState(false);
  const ended = useEnded();
  const pulse = (which: 1 | 2): TestPlan => ({
    ...kFirstPlan,
    mode: 'current',
    amplitude: which * pulses.current_a,
    seconds: 0.12,
    // The measured current swings beyond its target.
    max_current_a: 2 * Math.abs(which * pulses.current_a) + 1,
    max_speed_rpm: pulses.max_speed_rpm,
    // As patient as the test above: a busy computer lets no pulse end early that would not end that.
    max_feedback_age_ms: plan.max_feedback_age_ms,
    dead_man_ms: plan.dead_man_ms,
  });
  const measure = async () => {
    setMeasuring(true);
    ended.current = false;
    const slopes: number[] = [];
    for (const which of [1, 2] as const) {
      const outcome = await run(pulse(which));
      if ('refused' in outcome || outcome.done.report.abort !== null) break;
      slopes.push(outcome.done.report.acceleration_rpm_per_s ?? NaN);
      await stop(link, motor);
      if (ended.current) break;
    }
    setMeasuring(false);
    const [low, high] = slopes;
    // Both are above the friction, which is the same in both.
    return low === undefined || high === undefined ? null : (high - low) / pulses.current_a;
  };
  return { pulses, set: (part) => setPulses({ ...pulses, ...part }), pulse, measuring, measure };
}

/** `python`: the line that does the same in Python. */
export function MeasurementForm(props: { motor: string; of: Measurement; busy: boolean; python: string; onMeasure: () => void }) {
  const { word } = useStudio();
  const { pulses, set, measuring, pulse } = props.of;
  return (
    <form onSubmit={(event) => event.preventDefault()}>
      <fieldset>
        <legend>{word('testShape')}</legend>
        <label>
          <span>{word('proposalPulse')}</span>
          <NumberField label={word('proposalPulse')} value={pulses.current_a} disabled={props.busy} onValue={(value) => set({ current_a: value })} />
          <span class="hint">A</span>
        </label>
        <label>
          <span>{word('testMaxSpeed')}</span>
          <OptionalField label={word('testMaxSpeed')} value={pulses.max_speed_rpm} otherwise="" required disabled={props.busy} onValue={(value) => set({ max_speed_rpm: value })} />
          <span class="hint">rpm</span>
        </label>
        <label>
          <span>{word('proposalTime')}</span>
          <NumberField label={word('proposalTime')} value={pulses.time_constant_s} disabled={props.busy} onValue={(value) => set({ time_constant_s: value })} />
          <span class="hint">s</span>
        </label>
      </fieldset>
      <div class="toolbar">
        <button type="button" class="strong" disabled={props.busy || measuring || pulses.max_speed_rpm === null} onClick={props.onMeasure}>
          {word('proposalMeasure')}
        </button>
        <CopyLines
          request={{ operation: 'test', target: props.motor }}
          command={testCommand(props.motor, pulse(1))}
          python={props.python}
        />
      </div>
    </form>
  );
}
