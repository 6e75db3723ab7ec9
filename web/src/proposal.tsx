// Gains that a measurement proposes, and a search around them, judged by a step.
import { useState } from 'preact/hooks';

import { CopyLines } from './action';
import { useKnown, useStoredOfRobot, useStudio } from './context';
import { type LoopGains, kKi, kKp, loopGainsOf, scoreOf, searchGains, triedValuesOf, valuesOf } from './gain_search';
import { type Run, MeasurementForm, stop, useEnded, useMeasurement } from './measurement';
import { type TestPlan, proposalOf, testCommand } from './motion_test';
import { NumberField } from './number_field';
import { number } from './numbers';
import { filled } from './words_commission';

const kMostTries = 50;

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
  const { word } = useStudio();
  const robot = useKnown().robot?.robot.robot ?? '';
  const of = useMeasurement(props.motor, props.plan, props.run);
  const { current_a, time_constant_s } = of.pulses;
  const [told, setTold] = useState('');
  const [proposed, setProposed] = useState<LoopGains | null>(null);

  const measure = async () => {
    setTold('');
    const acceleration = await of.measure();
    if (acceleration === null) return;
    const gains = proposalOf(acceleration, of.pulses.time_constant_s);
    if (gains === null) return setTold(word('proposalNone'));
    setTold(`${number(acceleration, 0)} rpm/s/A: ${listed(gains)}`);
    setProposed(loopGainsOf(gains));
    props.onProposal(gains);
  };

  return (
    <section class="card test" aria-label={word('proposal')}>
      <h3>{word('proposal')}</h3>
      <p class="hint">{word('proposalHint')}</p>
      <MeasurementForm
        motor={props.motor}
        of={of}
        busy={props.busy}
        python={`python python/examples/pid_tuning.py ${robot} ${props.motor} --current ${current_a} --time-constant ${time_constant_s}`}
        onMeasure={() => void measure()}
      />
      {told !== '' && <p role="status">{told}</p>}
      <Search motor={props.motor} plan={props.plan} start={proposed} busy={props.busy || of.measuring} run={props.run} onProposal={props.onProposal} />
    </section>
  );
}
