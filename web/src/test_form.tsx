// A test of motion: its shape and its bounds, set before it begins, and its start and end.
import type { ComponentChildren } from 'preact';

import { CopyLines } from './action';
import { useStudio } from './context';
import { type TestMode, type TestPlan, isSines, kTestKinds, kTestUnits, testCommand, testPython } from './motion_test';
import { NumberField, OptionalField } from './number_field';

export interface Running {
  time_s: number;
  lasts_s: number;
}

type NumberKey = 'amplitude' | 'base' | 'from_hz' | 'to_hz' | 'max_feedback_age_ms' | 'dead_man_ms';
type OptionalKey = 'seconds' | 'rate_per_s' | 'max_current_a' | 'max_speed_rpm' | 'min_angle_deg' | 'max_angle_deg';

export function TestForm(props: {
  motor: string;
  modes: TestMode[];
  plan: TestPlan;
  running: Running | null;
  told: ComponentChildren;
  onPlan: (plan: TestPlan) => void;
  onStart: () => void;
  onStop: () => void;
}) {
  const { word } = useStudio();
  const { plan, running } = props;
  const busy = running !== null;
  const unit = kTestUnits[plan.mode];
  const room = Math.abs(plan.amplitude) / 2;
  const defaults = {
    speed: String(Math.abs(plan.base) + Math.abs(plan.amplitude) + room),
    lowest: plan.mode === 'total_angle' ? `${Math.min(0, isSines(plan.kind) ? -Math.abs(plan.amplitude) : plan.amplitude) - room}` : '−∞',
    highest: plan.mode === 'total_angle' ? `${Math.max(0, isSines(plan.kind) ? Math.abs(plan.amplitude) : plan.amplitude) + room}` : '∞',
  };
  const set = (part: Partial<TestPlan>) => props.onPlan({ ...plan, ...part });
  const field = (key: NumberKey, label: string, of: string) => (
    <label>
      <span>{label}</span>
      <NumberField label={label} value={plan[key]} disabled={busy} onValue={(value) => set({ [key]: value })} />
      <span class="hint">{of}</span>
    </label>
  );
  const optional = (key: OptionalKey, label: string, of: string, otherwise: string, required = false) => (
    <label>
      <span>{label}</span>
      <OptionalField
        label={label}
        value={plan[key]}
        otherwise={otherwise}
        required={required}
        disabled={busy}
        onValue={(value) => set({ [key]: value })}
      />
      <span class="hint">{of}</span>
    </label>
  );
  const tick = (key: 'linear' | 'stop_at_limits', label: string) => (
    <label>
      <input type="checkbox" checked={plan[key]} disabled={busy} onChange={() => set({ [key]: !plan[key] })} />
      <span class="wide">{label}</span>
    </label>
  );
  const missing = plan.max_current_a === null || (plan.mode !== 'velocity' && plan.max_speed_rpm === null);

  return (
    <section class="card test" aria-label={word('test')}>
      <h3>{word('test')}</h3>
      <form onSubmit={(event) => event.preventDefault()}>
        <fieldset>
          <legend>{word('testShape')}</legend>
          <label>
            <span>{word('testKind')}</span>
            <select aria-label={word('testKind')} value={plan.kind} disabled={busy} onChange={(event) => set({ kind: event.currentTarget.value as TestPlan['kind'] })}>
              {kTestKinds.map((kind) => (
                <option key={kind}>{kind}</option>
              ))}
            </select>
          </label>
          <label>
            <span>{word('mode')}</span>
            <select aria-label={word('mode')} value={plan.mode} disabled={busy} onChange={(event) => set({ mode: event.currentTarget.value as TestMode })}>
              {props.modes.map((mode) => (
                <option key={mode}>{mode}</option>
              ))}
            </select>
          </label>
          {field('amplitude', word('testAmplitude'), unit)}
          {plan.mode !== 'total_angle' && field('base', word('testBase'), unit)}
          {optional('seconds', word('testSeconds'), 's', isSines(plan.kind) ? String(Math.min(120, Math.max(10, Math.round(100 / plan.from_hz) / 10))) : '1.5')}
          {plan.kind === 'ramp' && optional('rate_per_s', word('testRate'), `${unit}/s`, '', true)}
          {isSines(plan.kind) && field('from_hz', word('testFrom'), 'Hz')}
          {isSines(plan.kind) && field('to_hz', word('testTo'), 'Hz')}
          {plan.kind === 'sweep' && tick('linear', word('testLinear'))}
        </fieldset>
        <fieldset>
          <legend>{word('testBounds')}</legend>
          {optional('max_current_a', word('testMaxCurrent'), 'A', '', true)}
          {optional('max_speed_rpm', word('testMaxSpeed'), 'rpm', plan.mode === 'velocity' ? defaults.speed : '', plan.mode !== 'velocity')}
          {optional('min_angle_deg', word('testMinAngle'), '°', defaults.lowest)}
          {optional('max_angle_deg', word('testMaxAngle'), '°', defaults.highest)}
          {field('max_feedback_age_ms', word('testAge'), 'ms')}
          {field('dead_man_ms', word('testSilence'), 'ms')}
          {tick('stop_at_limits', word('testAtLimits'))}
        </fieldset>
        <div class="toolbar">
          {busy ? (
            <button type="button" class="strong" onClick={props.onStop}>
              {word('testStop')}
            </button>
          ) : (
            <button type="button" class="strong" disabled={missing} onClick={props.onStart}>
              {word('testStart')}
            </button>
          )}
          <CopyLines
            request={{ operation: 'test', target: props.motor }}
            command={testCommand(props.motor, plan)}
            python={testPython(props.motor, plan)}
          />
          {busy && (
            <span class="hint" role="timer">
              {running.time_s === 0 ? word('testBegins') : `${running.time_s.toFixed(1)} / ${running.lasts_s.toFixed(1)} s`}
            </span>
          )}
        </div>
      </form>
      {missing && <p class="hint">{word('testMissing')}</p>}
      {!busy && props.told !== null && (
        <div class="told" role="status">
          {props.told}
        </div>
      )}
      {busy && <p class="hint">{word('testRuns')}</p>}
    </section>
  );
}
