// Tuning of one motor: tests of motion within bounds, gains beside them, and gains that a measurement proposes.
import { useEffect, useRef, useState } from 'preact/hooks';

import { useChosenMotor } from './chosen_motor';
import { useStored, useStoredOfRobot, useStudio } from './context';
import { loopGainsOf } from './gain_search';
import { Gains } from './gains';
import type { Run } from './measurement';
import { type TestPlan, type TestResult, kFirstPlan, kTestModes, kTestUnits, planOf } from './motion_test';
import { number, unitOf } from './numbers';
import { Curves } from './plots';
import { Proposal } from './proposal';
import { SpringProposal } from './spring_proposal';
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
  const [loops, setLoops] = useState<{ motor: string; isHere: boolean } | null>(null);
  const end = useRef<((why: 'stopped' | 'left') => void) | null>(null);
  const modes = kTestModes.filter((mode) => info?.modes.includes(mode));
  const plan = { ...stored, mode: modes.includes(stored.mode) ? stored.mode : (modes[0] ?? 'velocity') };

  const keep = (next: TestResult[]) => {
    kept = next.slice(-kMostResults);
    setResults(kept);
  };

  const run: Run = async (wanted, isKept = true) => {
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
    if (report.ticks === 0 || !isKept) return outcome;
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
  // Whether rc10d closes its velocity loop; null: not known yet.
  const isHere = loops?.motor === name ? loops.isHere : null;
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
          {isHere !== false && info.modes.includes('current') && info.modes.includes('velocity') && (
            <Proposal key={`proposal ${name}`} motor={name} plan={plan} busy={running !== null} run={run} onProposal={setProposed} />
          )}
          {isHere === false && info.modes.includes('current') && info.modes.includes('impedance') && (
            <SpringProposal key={`spring ${name}`} info={info} plan={plan} busy={running !== null} run={run} />
          )}
          <Gains
            key={`gains ${name}`}
            motor={name}
            proposed={proposed}
            onKnown={(values) => setLoops({ motor: name, isHere: values !== null && loopGainsOf(values) !== null })}
          />
        </div>
        <div class="curves">
          <Curves signals={readings.map((reading) => `${name}.${reading}`)} unit={unit} />
          <TestResults results={results} onRemove={(id) => keep(kept.filter((each) => each.id !== id))} />
        </div>
      </div>
    </>
  );
}
