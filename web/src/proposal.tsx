// Gains that a measurement proposes, and a search around them, judged by a step.
import { useEffect, useRef, useState } from 'preact/hooks';

import { CopyLines } from './action';
import { useKnown, useStoredOfRobot, useStudio } from './context';
import { type LoopGains, kKi, kKp, loopGainsOf, scoreOf, searchGains, triedValuesOf, valuesOf } from './gain_search';
import type { Link, TestOutcome } from './link';
import { type TestPlan, kFirstPlan, proposalOf, testCommand } from './motion_test';
import { NumberField, OptionalField } from './number_field';
import { number } from './numbers';
import { filled } from './words_commission';

/** `isKept`: among the results. */
export type Run = (plan: TestPlan, isKept?: boolean) => Promise<TestOutcome>;

const kMostTries = 50;

/** Whether the part was left, or Escape pressed, since this was false: between two tests none is there to be ended. */
function useEnded(): { current: boolean } {
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
async function stop(link: Link, motor: string): Promise<void> {
  const now = () => link.known.state?.data.motors.find((each) => each.name === motor);
  const held = link.hold({ motor, mode: 'velocity', value: 0 }, () => {});
  for (let i = 0; i < 40; ++i) {
    await pause();
    if (document.hidden || !held.renew() || Math.abs(now()?.velocity_rpm ?? 0) < 1) break;
  }
  held.release();
  for (let i = 0; i < 40 && (i < kLeasePauses || now()?.owner !== ''); ++i) await pause();
}

const listed = (values: Record<string, number>) =>
  Object.entries(values)
    .map(([key, value]) => `${key} ${value}`)
    .join(', ');

/** Steps with gains around these; those in force before are in force again at the end. */
function Search(props: { motor: string; plan: TestPlan; start: LoopGains | null; busy: boolean; run: Run; onProposal: (gains: Record<string, number>) => void }) {
  const { link, word } = useStudio();
  const robot = useKnown().robot?.robot.robot ?? '';
  const [tries, setTries] = useStoredOfRobot('searchTries', 12);
  const [told, setTold] = useState<{ text: string; isBad: boolean }>({ text: '', isBad: false });
  const [searching, setSearching] = useState(false);
  const ended = useEnded();
  const { motor, plan } = props;
  const seconds = plan.seconds ?? 1;
  const judges = plan.kind === 'step' && plan.mode === 'velocity' && plan.max_current_a !== null;

  const searchFrom = async (before: LoopGains): Promise<{ text: string; isBad: boolean }> => {
    let why = word('searchEnded');
    let tried = 0;
    const badness = async (gains: LoopGains | null) => {
      if (ended.current) return null;
      if (gains !== null) {
        const answer = await link.ask({ operation: 'set_gains', target: motor, values: triedValuesOf(gains) });
        if (answer.status !== 'ok') {
          why = answer.message;
          return null;
        }
        // By Escape, or by leaving, before there was an answer: nothing moves any more.
        if (ended.current) return null;
      }
      const outcome = await props.run(plan, gains === null);
      if ('refused' in outcome || outcome.done.report.abort !== null) return null;
      await stop(link, motor);
      const score = scoreOf(outcome.done.report.step, seconds, plan.amplitude);
      if (gains !== null) setTold({ text: `${++tried}/${tries} ${listed(valuesOf(gains))}: ${number(score, 3)} s`, isBad: false });
      return score;
    };
    const first = await badness(null);
    const best = first === null ? null : await searchGains(badness, props.start ?? before, tries);
    const back = await link.ask({ operation: 'set_gains', target: motor, values: { [kKp]: before.kp, [kKi]: before.ki } });
    if (back.status !== 'ok') return { text: `${word('searchNotBack')} ${back.message}`, isBad: true };
    if (first === null || best === null) return { text: why, isBad: true };
    const scores = { before: number(first, 3), after: number(best.score, 3) };
    if (best.score >= first) return { text: filled(word('searchNoBetter'), scores), isBad: false };
    props.onProposal(valuesOf(best.gains));
    return { text: `${filled(word('searchBest'), scores)} ${listed(valuesOf(best.gains))}`, isBad: false };
  };

  const search = async () => {
    setSearching(true);
    setTold({ text: '', isBad: false });
    ended.current = false;
    const config = await link.ask({ operation: 'get_config', target: motor });
    const before = config.status === 'ok' ? loopGainsOf(config.values) : null;
    setTold(before === null ? { text: config.status === 'ok' ? word('searchNoLoop') : config.message, isBad: true } : await searchFrom(before));
    setSearching(false);
  };

  return (
    <>
      <p class="hint">{word(judges ? 'searchHint' : 'searchNeedsStep')}</p>
      <div class="toolbar">
        <label>
          {`${word('searchTries')} `}
          <NumberField
            label={word('searchTries')}
            least={1}
            value={tries}
            disabled={props.busy || searching}
            onValue={(value) => setTries(Math.min(kMostTries, Math.max(1, Math.round(value))))}
          />
        </label>
        <button type="button" disabled={!judges || props.busy || searching} onClick={() => void search()}>
          {word('search')}
        </button>
        <CopyLines
          command={testCommand(motor, plan)}
          python={`python python/examples/pid_tuning.py ${robot} ${motor} --rpm ${plan.amplitude} --seconds ${seconds} --tries ${tries}`}
        />
      </div>
      {told.text !== '' && (
        <p class={told.isBad ? 'refused' : ''} role={told.isBad ? 'alert' : 'status'}>
          {told.text}
        </p>
      )}
    </>
  );
}

/** Two pulses of current, after which the gains of the velocity loop are proposed. */
export function Proposal(props: { motor: string; plan: TestPlan; busy: boolean; run: Run; onProposal: (gains: Record<string, number>) => void }) {
  const { link, word } = useStudio();
  const robot = useKnown().robot?.robot.robot ?? '';
  const [wanted, setWanted] = useStoredOfRobot(`proposal/${props.motor}`, { current_a: 1, max_speed_rpm: null as number | null, time_constant_s: 0.03 });
  const [told, setTold] = useState('');
  const [measuring, setMeasuring] = useState(false);
  const [proposed, setProposed] = useState<LoopGains | null>(null);
  const ended = useEnded();

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
        // As patient as the test above: a busy computer lets no pulse end early that would not end that.
        max_feedback_age_ms: props.plan.max_feedback_age_ms,
        dead_man_ms: props.plan.dead_man_ms,
      });
      if ('refused' in outcome || outcome.done.report.abort !== null) break;
      slopes.push(outcome.done.report.acceleration_rpm_per_s ?? NaN);
      await stop(link, props.motor);
      if (ended.current) break;
    }
    setMeasuring(false);
    const [low, high] = slopes;
    if (low === undefined || high === undefined) return;
    // Both are above the friction, which is the same in both.
    const acceleration = (high - low) / wanted.current_a;
    const gains = proposalOf(acceleration, wanted.time_constant_s);
    if (gains === null) return setTold(word('proposalNone'));
    setTold(`${number(acceleration, 0)} rpm/s/A: ${listed(gains)}`);
    setProposed(loopGainsOf(gains));
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
      <Search motor={props.motor} plan={props.plan} start={proposed} busy={props.busy || measuring} run={props.run} onProposal={props.onProposal} />
    </section>
  );
}
