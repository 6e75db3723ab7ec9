// Part "Commission": the first time of one motor, step by step. Findings stay in this browser; none of them acts.
import { useEffect, useRef, useState } from 'preact/hooks';

import { CommissionEnd } from './commission_end';
import { Picture } from './commission_picture';
import {
  type CommissionRecord,
  type Judged,
  type Measured,
  type Step,
  hasLostItsAngle,
  holdsNow,
  isOn,
  judgeSpin,
  judgeStep,
  kFirstRecord,
  kNeeds,
  kSteps,
  linesOf,
} from './commission_record';
import { AloneTest } from './commission_spin';
import { BusStep, HandStep, LimitsStep, ZeroStep } from './commission_steps';
import { useKnown, useStored, useStoredOfRobot, useStudio } from './context';
import type { TestOutcome } from './link';
import { type TestPlan, kFirstPlan } from './motion_test';
import { NumberField } from './number_field';
import { number } from './numbers';
import type { CheckedConfig, CheckedMotor } from './protocol';
import { filled, kStepWords } from './words_commission';

type Robot = NonNullable<CheckedConfig['checked']['robot']>;

/** The file that runs and rc10d's report of it; null: not known yet, or not to this page. */
interface Running {
  text: string;
  robot: Robot | null;
}

function useRunning(): Running | null {
  const { link } = useStudio();
  const known = useKnown();
  const [running, setRunning] = useState<Running | null>(null);
  const hash = known.robot?.robot.config_hash ?? '';
  useEffect(() => {
    let gone = false;
    setRunning(null);
    const load = async () => {
      const file = await link.config();
      if (gone || typeof file === 'string' || file.of !== 'running' || file.config.why !== '') return;
      const answer = await link.checkConfig(file.config.text);
      if (!gone) setRunning({ text: file.config.text, robot: typeof answer === 'string' ? null : answer.checked.robot });
    };
    if (hash !== '') void load();
    return () => {
      gone = true;
    };
  }, [hash, link]);
  return running;
}

/** Motor, its record and its report, for a step. */
export interface StepProps {
  motor: string;
  record: CommissionRecord;
  checked: CheckedMotor | null;
  /** Keeps settings of the steps. */
  onSet: (part: Partial<CommissionRecord>) => void;
  onFound: (step: Measured, judged: Judged) => void;
}

function corridor(props: StepProps, now_deg: number): Partial<TestPlan> {
  const { angle_min_deg: low, angle_max_deg: high } = props.record.lines;
  if (low === undefined || high === undefined) return {};
  return { min_angle_deg: Math.min(0, low - now_deg), max_angle_deg: Math.max(0, high - now_deg) };
}

function useAngle(motor: string): number {
  const known = useKnown();
  return known.state?.data.motors.find((each) => each.name === motor)?.total_angle_deg ?? NaN;
}

function Told(props: { outcome: TestOutcome | null }) {
  const { word } = useStudio();
  const { outcome } = props;
  if (outcome === null) return null;
  const abort = 'refused' in outcome ? null : outcome.done.report.abort;
  return (
    <p class="refused" role="alert">
      {`${word('comNotJudged')} ${'refused' in outcome ? outcome.refused : abort === null ? '' : `${abort.text} (${abort.criterion})`}`}
    </p>
  );
}

function SpinStep(props: StepProps & { modes: string[] }) {
  const { link, word } = useStudio();
  const { record, motor } = props;
  const now_deg = useAngle(motor);
  const [told, setTold] = useState<TestOutcome | null>(null);
  const begun_us = useRef(0);
  if (!props.modes.includes('current')) return <p class="notice">{word('comNoCurrent')}</p>;
  const plan: TestPlan = {
    ...kFirstPlan,
    mode: 'current',
    amplitude: record.current_a,
    seconds: 1,
    // The measured current swings beyond its target.
    max_current_a: 2 * Math.abs(record.current_a) + 1,
    max_speed_rpm: record.over_speed_rpm,
    ...corridor(props, now_deg),
  };
  const judge = (outcome: TestOutcome) => {
    const lost = hasLostItsAngle(link.known.events, motor, begun_us.current);
    const judged = 'refused' in outcome ? null : judgeSpin(motor, outcome.done, outcome.curve, lost);
    setTold(judged === null ? outcome : null);
    if (judged !== null) props.onFound('spin', judged);
  };
  return (
    <>
      <div class="toolbar">
        <label>
          {`${word('comSpinCurrent')} `}
          <NumberField label={word('comSpinCurrent')} value={record.current_a} least={0} onValue={(value) => props.onSet({ current_a: Math.min(20, Math.abs(value)) })} />
          {' A'}
        </label>
        <label>
          {`${word('comSpinSpeed')} `}
          <NumberField label={word('comSpinSpeed')} value={record.over_speed_rpm} least={1} onValue={(value) => props.onSet({ over_speed_rpm: Math.max(1, value) })} />
          {' rpm'}
        </label>
      </div>
      <div onPointerDownCapture={() => (begun_us.current = link.known.state?.data.mono_us ?? 0)} onKeyDownCapture={() => (begun_us.current = link.known.state?.data.mono_us ?? 0)}>
        <AloneTest motor={motor} plan={plan} label={word('comSpinHold')} loops={props.checked?.untested_loops ?? null} onOutcome={judge} />
      </div>
      <Told outcome={told} />
    </>
  );
}

/** A small step: of the angle where the travel is known, else of the speed. */
function firstStep(props: StepProps & { modes: string[] }, now_deg: number): TestPlan | null {
  const { record } = props;
  const { angle_min_deg: low, angle_max_deg: high } = record.lines;
  const bounds = { max_current_a: record.step_max_current_a, ...corridor(props, now_deg) };
  if (low !== undefined && high !== undefined && props.modes.includes('total_angle')) {
    const size = Math.min(10, Math.floor((high - low) * 2.5) / 10);
    const amplitude = now_deg > (low + high) / 2 ? -size : size;
    return { ...kFirstPlan, ...bounds, mode: 'total_angle', amplitude, max_speed_rpm: record.over_speed_rpm };
  }
  if (!props.modes.includes('velocity')) return null;
  return { ...kFirstPlan, ...bounds, mode: 'velocity', amplitude: 20, max_speed_rpm: Math.max(record.over_speed_rpm, 30) };
}

function FirstStep(props: StepProps & { modes: string[] }) {
  const { word } = useStudio();
  const { record, motor } = props;
  const now_deg = useAngle(motor);
  const [told, setTold] = useState<TestOutcome | null>(null);
  const plan = firstStep(props, now_deg);
  if (plan === null) return <p class="notice">{word('testNone')}</p>;
  const judge = (outcome: TestOutcome) => {
    // The sign is that of the step that was made.
    const made = 'refused' in outcome ? 0 : ((outcome.curve[1]?.at(-1) ?? 0) - (plan.mode === 'total_angle' ? outcome.done.report.origin : 0));
    const judged = 'refused' in outcome ? null : judgeStep(motor, outcome.done, made, outcome.curve);
    setTold(judged === null ? outcome : null);
    if (judged !== null) props.onFound('step', judged);
  };
  return (
    <>
      <p>{filled(word(plan.mode === 'total_angle' ? 'comStepAngle' : 'comStepVelocity'), { size: number(plan.amplitude, Number.isInteger(plan.amplitude) ? 0 : 1) })}</p>
      <div class="toolbar">
        <label>
          {`${word('testMaxCurrent')} `}
          <NumberField label={word('testMaxCurrent')} value={record.step_max_current_a} least={0} onValue={(value) => props.onSet({ step_max_current_a: Math.abs(value) })} />
          {' A'}
        </label>
      </div>
      <AloneTest motor={motor} plan={plan} label={word('comStepHold')} loops={props.checked?.untested_loops ?? null} onOutcome={judge} />
      <Told outcome={told} />
    </>
  );
}

/** Motors that may move: the steps by hand wait for their rest. */
function MotorsOn() {
  const { word } = useStudio();
  const known = useKnown();
  const on = (known.state?.data.motors ?? []).filter(isOn).map((each) => each.name);
  if (on.length === 0) return null;
  return (
    <p class="notice" role="alert">
      {`${word('comOthersOn')} ${on.join(', ')}`}
    </p>
  );
}

export function Commission() {
  const { word } = useStudio();
  const known = useKnown();
  const [stored, setMotor] = useStored('moveMotor', '');
  const infos = known.robot?.robot.motors ?? [];
  const info = infos.find((each) => each.name === stored) ?? infos[0];
  const motor = info?.name ?? '';
  const [kept, keep] = useStoredOfRobot<CommissionRecord>(`commission/${motor}`, kFirstRecord);
  const newest = useRef(kept);
  newest.current = kept;
  const running = useRunning();
  const robot = known.robot;
  if (info === undefined || robot === null) return null;

  const set = (part: Partial<CommissionRecord>) => {
    newest.current = { ...newest.current, ...part };
    keep(newest.current);
  };
  const checked = running?.robot?.buses.flatMap((bus) => bus.motors).find((each) => each.name === motor) ?? null;
  const holds = (step: Measured, of = kept) => holdsNow(step, of.found[step], robot);
  const record = { ...kFirstRecord, ...kept, lines: linesOf(kept.lines, holds) };
  const props: StepProps = {
    motor,
    record,
    checked,
    onSet: set,
    onFound: (step, { lines, ...judged }) => {
      const before = newest.current;
      const finding = { at: new Date().toISOString(), hash: robot.robot.config_hash, pid: robot.robot.pid, ...judged };
      const found = { ...before.found, [step]: finding };
      // Earlier findings of this step are over, and limits count from the zero.
      if (step === 'zero') delete found.limits;
      const kept_lines = linesOf(before.lines, (each) => each !== step && holds(each, { ...before, found }));
      set({ found, lines: { ...kept_lines, ...lines }, ...(step === 'zero' ? { low_deg: null, high_deg: null } : {}) });
    },
  };
  const shown: Step = kSteps.includes(record.shown) ? record.shown : 'bus';
  const at = kSteps.indexOf(shown);
  const sign = (step: Step) => {
    const finding = step === 'end' ? undefined : record.found[step];
    if (step === 'end' || finding === undefined) return ['○', ''] as const;
    if (!holds(step)) return ['↺', 'old'] as const;
    return finding.good ? (['✓', 'good'] as const) : (['✗', 'bad'] as const);
  };
  const finding = shown === 'end' ? undefined : record.found[shown];
  const modes = info.modes;
  const missing = (kNeeds[shown] ?? []).filter((step) => record.found[step]?.good !== true || !holds(step));
  return (
    <>
      <div class="toolbar no-print">
        <label>
          {`${word('motor')} `}
          <select value={motor} onChange={(event) => setMotor(event.currentTarget.value)}>
            {infos.map((each) => (
              <option key={each.name}>{each.name}</option>
            ))}
          </select>
        </label>
        <span class={`badge status ${known.state?.data.motors.find((each) => each.name === motor)?.status.toLowerCase() ?? ''}`}>
          {known.state?.data.motors.find((each) => each.name === motor)?.status ?? '–'}
        </span>
        <button type="button" onClick={() => set({ ...kFirstRecord })}>
          {word('comAnew')}
        </button>
        <span class="hint">{word('comKept')}</span>
      </div>
      <div class="commission">
        <ol class="steps no-print" aria-label={word('commission')}>
          {kSteps.map((step) => (
            <li key={step}>
              <button type="button" aria-current={step === shown ? 'step' : undefined} onClick={() => set({ shown: step })}>
                <span class={`sign ${sign(step)[1]}`}>{sign(step)[0]}</span> {word(kStepWords[step])}
              </button>
            </li>
          ))}
        </ol>
        <section class="card step" key={`${motor} ${shown}`} aria-label={word(kStepWords[shown])}>
          <h3>{`${at + 1}. ${word(kStepWords[shown])}`}</h3>
          <Picture step={shown} />
          {['bus', 'hand', 'zero', 'limits'].includes(shown) && <MotorsOn />}
          {shown === 'bus' && <BusStep {...props} bus={info.bus} id={info.id} robot={running?.robot ?? null} text={running?.text ?? null} />}
          {shown === 'hand' && <HandStep {...props} />}
          {shown === 'zero' && <ZeroStep {...props} />}
          {shown === 'limits' && <LimitsStep {...props} />}
          {missing.length > 0 && (
            <p class="notice" role="alert">
              {`${word('comFirst')} ${missing.map((step) => word(kStepWords[step])).join(' · ')}`}
            </p>
          )}
          {shown === 'spin' && missing.length === 0 && <SpinStep {...props} modes={modes} />}
          {shown === 'step' && missing.length === 0 && <FirstStep {...props} modes={modes} />}
          {shown === 'end' && <CommissionEnd {...props} robot={robot} info={info} text={running?.text ?? null} />}
          {finding !== undefined && (
            <div class={`told ${finding.good ? 'good' : 'bad'}`} role="status">
              <strong>{`${finding.good ? '✓' : '✗'} ${filled(word(finding.word), finding.values)}`}</strong>
              {sign(shown)[1] === 'old' && <p class="hint">{word('comOld')}</p>}
            </div>
          )}
          {shown !== 'end' && (
            <div class="toolbar no-print">
              <button type="button" class={finding?.good === true ? 'strong' : ''} onClick={() => set({ shown: kSteps[at + 1] ?? 'end' })}>
                {word('comNext')}
              </button>
            </div>
          )}
        </section>
      </div>
    </>
  );
}
