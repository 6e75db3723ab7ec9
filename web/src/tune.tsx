// Tuning of one motor: tests of motion within bounds, gains beside them, and gains that a measurement proposes.
import { useEffect, useRef, useState } from 'preact/hooks';

import { CopyLines } from './action';
import { useChosenMotor } from './chosen_motor';
import { useKnown, useStored, useStoredOfRobot, useStudio } from './context';
import { Gains } from './gains';
import type { TestOutcome } from './link';
import { type TestPlan, type TestResult, kFirstPlan, kTestModes, kTestUnits, planOf, proposalOf } from './motion_test';
import { NumberField, OptionalField } from './number_field';
import { number, unitOf } from './numbers';
import { Curves } from './plots';
import { TestForm, type Running } from './test_form';
import { TestResults } from './test_results';
import type { Word } from './words';

const kMostResults = 8;
// They stay until the page is loaded anew: curves of every tick are too large for the browser's memory of settings.
let kept: TestResult[] = [];
let numbered = 0;

const kCriteria: Record<string, Word> = {
  angle: 'endAngle',
  velocity: 'endVelocity',
  current: 'endCurrent',
  feedback_age: 'endAge',
  limit: 'endLimit',
  ownership: 'endOwnership',
  status: 'endStatus',
  connection: 'endConnection',
  interrupted: 'endInterrupted',
  silence: 'endSilence',
};

type Run = (plan: TestPlan) => Promise<TestOutcome>;

/** Two pulses of current, after which the gains of the velocity loop are proposed. */
function Proposal(props: { motor: string; busy: boolean; run: Run; onProposal: (gains: Record<string, number>) => void }) {
  const { link, word } = useStudio();
  const robot = useKnown().robot?.robot.robot ?? '';
  const [wanted, setWanted] = useStoredOfRobot(`proposal/${props.motor}`, { current_a: 1, max_speed_rpm: null as number | null, time_constant_s: 0.03 });
  const [told, setTold] = useState('');
  const [measuring, setMeasuring] = useState(false);
  // Between the pulses no test is there to be ended.
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

  // Until it stands, or 2 s are over: the next pulse begins from rest.
  const stop = async () => {
    const held = link.hold({ motor: props.motor, mode: 'velocity', value: 0 }, () => {});
    for (let i = 0; i < 40; ++i) {
      await new Promise((resolve) => setTimeout(resolve, 50));
      const velocity_rpm = link.known.state?.data.motors.find((each) => each.name === props.motor)?.velocity_rpm;
      if (document.hidden || !held.renew() || Math.abs(velocity_rpm ?? 0) < 1) break;
    }
    held.release();
  };

  const measure = async () => {
    setTold('');
    setMeasuring(true);
    ended.current = false;
    const slopes: number[] = [];
    for (const pulse of [1, 2]) {
      const amplitude = pulse * wanted.current_a;
      const outcome = await props.run({
        ...kFirstPlan,
        mode: 'current',
        amplitude,
        seconds: 0.12,
        // The measured current swings beyond its target.
        max_current_a: 2 * Math.abs(amplitude) + 1,
        max_speed_rpm: wanted.max_speed_rpm,
      });
      if ('refused' in outcome || outcome.done.report.abort !== null) break;
      slopes.push(outcome.done.report.acceleration_rpm_per_s ?? NaN);
      await stop();
      if (ended.current) break;
    }
    setMeasuring(false);
    const [low, high] = slopes;
    if (low === undefined || high === undefined) return;
    // Both are above the friction, which is the same in both.
    const acceleration = (high - low) / wanted.current_a;
    const gains = proposalOf(acceleration, wanted.time_constant_s);
    if (gains === null) return setTold(word('proposalNone'));
    setTold(`${number(acceleration, 0)} rpm/s/A: ${Object.entries(gains).map(([key, value]) => `${key} ${value}`).join(', ')}`);
    props.onProposal(gains);
  };

  return (
    <section class="card test" aria-label={word('proposal')}>
      <h3>{word('proposal')}</h3>
      <p class="hint">{word('proposalHint')}</p>
      <form onSubmit={(event) => event.preventDefault()}>
        <fieldset>
          <legend>{word('testShape')}</legend>
          <label>
            <span>{word('proposalPulse')}</span>
            <NumberField label={word('proposalPulse')} value={wanted.current_a} disabled={props.busy} onValue={(value) => setWanted({ ...wanted, current_a: value })} />
            <span class="hint">A</span>
          </label>
          <label>
            <span>{word('testMaxSpeed')}</span>
            <OptionalField label={word('testMaxSpeed')} value={wanted.max_speed_rpm} otherwise="" required disabled={props.busy} onValue={(value) => setWanted({ ...wanted, max_speed_rpm: value })} />
            <span class="hint">rpm</span>
          </label>
          <label>
            <span>{word('proposalTime')}</span>
            <NumberField label={word('proposalTime')} value={wanted.time_constant_s} disabled={props.busy} onValue={(value) => setWanted({ ...wanted, time_constant_s: value })} />
            <span class="hint">s</span>
          </label>
        </fieldset>
        <div class="toolbar">
          <button type="button" class="strong" disabled={props.busy || measuring || wanted.max_speed_rpm === null} onClick={() => void measure()}>
            {word('proposalMeasure')}
          </button>
          <CopyLines
            request={{ operation: 'test', target: props.motor }}
            command={`rc10ctl test-motion ${props.motor} step ${wanted.current_a} --mode current --for 0.12s --max-current ${2 * Math.abs(wanted.current_a) + 1} --max-speed ${wanted.max_speed_rpm ?? 'RPM'}`}
            python={`python python/examples/pid_tuning.py ${robot} ${props.motor} --current ${wanted.current_a} --time-constant ${wanted.time_constant_s}`}
          />
        </div>
      </form>
      {told !== '' && <p role="status">{told}</p>}
    </section>
  );
}

export function Tune() {
  const { link, word } = useStudio();
  const { info, bar } = useChosenMotor();
  const name = info?.name ?? '';
  const [stored, setPlan] = useStoredOfRobot<TestPlan>(`test/${name}`, kFirstPlan);
  const [angle] = useStored('moveAngle', false);
  const [running, setRunning] = useState<Running | null>(null);
  const [told, setTold] = useState<{ end: string; text: string } | null>(null);
  const [results, setResults] = useState(kept);
  const [proposed, setProposed] = useState<Record<string, number> | null>(null);
  const end = useRef<((why: 'stopped' | 'left') => void) | null>(null);
  const modes = kTestModes.filter((mode) => info?.modes.includes(mode));
  const plan = { ...stored, mode: modes.includes(stored.mode) ? stored.mode : (modes[0] ?? 'velocity') };

  const keep = (next: TestResult[]) => {
    kept = next.slice(-kMostResults);
    setResults(kept);
  };

  const run: Run = async (wanted) => {
    setTold(null);
    setRunning({ time_s: 0, lasts_s: 0 });
    const gains = link.ask({ operation: 'get_config', target: name });
    let begun = false;
    const test = link.runTest({ motor: name, ...planOf(wanted) }, (time_s, lasts_s) => {
      begun = true;
      setRunning({ time_s, lasts_s });
    });
    end.current = test.end;
    const outcome = await test.outcome;
    end.current = null;
    setRunning(null);
    if ('refused' in outcome) {
      setTold({ end: begun ? `${word('testEndedBy')} ${word('endPage')}` : word('testRefused'), text: outcome.refused });
      return outcome;
    }
    const { report, doing, time_s } = outcome.done;
    const abort = report.abort;
    const criterion = abort === null ? undefined : kCriteria[abort.criterion];
    setTold(
      abort === null
        ? { end: word('testDone'), text: `${name} ${doing}` }
        : {
            end: `${word('testEndedBy')} ${criterion === undefined ? abort.criterion : word(criterion)} (${abort.criterion}), ${number(time_s, 3)} s`,
            text: `${abort.text}; ${name} ${doing}`,
          },
    );
    if (report.ticks === 0) return outcome;
    const config = await gains;
    const id = `${++numbered}`;
    const title = `#${id} ${name} ${report.kind} ${wanted.amplitude} ${kTestUnits[report.mode]}`;
    keep([...kept, { id, name: title, plan: wanted, report, gains: config.status === 'ok' ? config.values : {}, curve: outcome.curve }]);
    return outcome;
  };

  // A part that is left, or another motor, ends it; so does Escape.
  useEffect(() => {
    const key = (event: KeyboardEvent) => event.key === 'Escape' && end.current?.('stopped');
    window.addEventListener('keydown', key);
    return () => {
      window.removeEventListener('keydown', key);
      end.current?.('left');
    };
  }, [name]);

  if (info === undefined) return null;
  const unit = (signal: string) => (signal.endsWith('.target_shaped') ? kTestUnits[plan.mode] : unitOf(signal));
  const readings = ['target_shaped', 'velocity_rpm', 'current_a', ...(angle || plan.mode === 'total_angle' ? ['total_angle_deg'] : [])];
  return (
    <>
      {bar}
      <div class="move tune">
        <div class="side">
          {modes.length > 0 ? (
            <TestForm
              motor={name}
              modes={modes}
              plan={plan}
              running={running}
              told={
                told === null ? null : (
                  <>
                    <strong>{told.end}</strong>
                    <p>{told.text}</p>
                  </>
                )
              }
              onPlan={setPlan}
              onStart={() => void run(plan)}
              onStop={() => end.current?.('stopped')}
            />
          ) : (
            <p class="hint">{word('testNone')}</p>
          )}
          {info.modes.includes('current') && info.modes.includes('velocity') && (
            <Proposal key={`proposal ${name}`} motor={name} busy={running !== null} run={run} onProposal={setProposed} />
          )}
          <Gains key={`gains ${name}`} motor={name} proposed={proposed} />
        </div>
        <div class="curves">
          <Curves signals={readings.map((reading) => `${name}.${reading}`)} unit={unit} />
          <TestResults results={results} onRemove={(id) => keep(kept.filter((each) => each.id !== id))} />
        </div>
      </div>
    </>
  );
}
