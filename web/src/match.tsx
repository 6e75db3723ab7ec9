import { useKnown, useStored, useStudio } from './context';
import { NumberField } from './number_field';
import type { Known } from './link';
import { duration, number } from './numbers';
import type { Diagnostics, Robot, State } from './protocol';
import type { Word } from './words';

const kFeedbackLate_us = 1e6;
const kDefaultHot_c = 60;
// Fewer digits than these are met by chance.
const kLeastHashDigits = 12;

/** One condition of a match. */
interface Check {
  name: Word;
  good: boolean;
  found: string;
  /** Sentences of rc10d about it. */
  notes?: string[];
  remedy: Word;
}

/** Counts of one run of rc10d from which errors are counted. */
interface Baseline {
  pid: number;
  counts: Record<string, number>;
}

interface Wishes {
  hot_c: number;
  hash: string;
  baseline: Baseline;
}

/** All that goes up when something went wrong. */
function countsOf(diagnostics: Diagnostics): Record<string, number> {
  const counts: Record<string, number> = { missed_ticks: diagnostics.data.missed_ticks };
  for (const bus of diagnostics.data.buses) {
    counts[`${bus.name} errors`] = bus.error_frames;
    counts[`${bus.name} dropped`] = bus.rx_dropped + bus.tx_dropped;
    counts[`${bus.name} foreign`] = bus.rx_foreign;
    counts[`${bus.name} restarts`] = bus.restarts;
  }
  return counts;
}

function list(names: string[]): string {
  return names.join(', ');
}

function isAsCommitted(running: string, wanted: string): boolean {
  return wanted.length >= kLeastHashDigits && running.startsWith(wanted);
}

function checksOf(
  robot: Robot,
  state: State,
  diagnostics: Diagnostics | null,
  wishes: Wishes,
  word: (word: Word) => string,
): Check[] {
  const data = state.data;
  const motors = data.motors;
  const missing = motors.filter((motor) => motor.status === 'OFFLINE' || motor.feedback_age_us < 0 || motor.feedback_age_us > kFeedbackLate_us);
  const faults = motors.filter((motor) => motor.status === 'FAULT');
  const unreferenced = motors.filter((motor) => !motor.zeroed);
  // A motor whose limit has come down is hot by its own file, whatever this page asks for.
  const hot = motors.filter(
    (motor) => motor.limits.includes('temperature') || (motor.temperature_c !== null && motor.temperature_c > wishes.hot_c),
  );
  const warmest = motors.reduce<number | null>((most, motor) => (motor.temperature_c === null ? most : Math.max(most ?? -Infinity, motor.temperature_c)), null);
  const oldest_us = Math.max(0, ...motors.map((motor) => motor.feedback_age_us));
  const simulated = data.conditions.includes('simulated');

  const buses = diagnostics?.data.buses ?? [];
  const down = buses.filter((bus) => bus.state !== 'active');
  const before = wishes.baseline.pid === robot.robot.pid ? wishes.baseline.counts : {};
  const grown = Object.entries(diagnostics === null ? {} : countsOf(diagnostics))
    .map(([name, count]): [string, number] => [name, count - (before[name] ?? 0)])
    .filter(([, count]) => count > 0);
  const missed = grown.find(([name]) => name === 'missed_ticks')?.[1] ?? 0;
  const dirt = grown.filter(([name]) => name !== 'missed_ticks').map(([name, count]) => `${name} ${count}`);
  const notices = diagnostics?.data.notices ?? [];

  return [
    {
      name: 'matchState',
      good: data.state === 'RUN',
      found: data.state === 'RUN' ? 'RUN' : `${data.state}: ${data.stop_cause}${data.stopped_by === '' ? '' : ` (${data.stopped_by})`}`,
      remedy: 'matchStateRemedy',
    },
    { name: 'matchReal', good: !simulated, found: word(simulated ? 'simulated' : 'matchRealFound'), remedy: 'matchRealRemedy' },
    {
      name: 'matchHeard',
      good: motors.length > 0 && missing.length === 0,
      found: missing.length > 0 ? list(missing.map((motor) => motor.name)) : `${motors.length} · ${word('age')} ≤ ${duration(oldest_us)}`,
      remedy: 'matchHeardRemedy',
    },
    {
      name: 'matchFaults',
      good: faults.length === 0,
      found: faults.length === 0 ? word('none') : list(faults.map((motor) => `${motor.name}: ${motor.fault_text}`)),
      remedy: 'matchFaultsRemedy',
    },
    {
      name: 'matchReferenced',
      good: unreferenced.length === 0,
      found: unreferenced.length === 0 ? word('all') : list(unreferenced.map((motor) => motor.name)),
      remedy: 'matchReferencedRemedy',
    },
    {
      name: 'matchCool',
      good: hot.length === 0,
      found: hot.length === 0 ? `≤ ${number(warmest, 0)} °C` : list(hot.map((motor) => `${motor.name} ${number(motor.temperature_c, 0)} °C`)),
      remedy: 'matchCoolRemedy',
    },
    {
      name: 'matchBuses',
      good: buses.length > 0 && down.length === 0 && dirt.length === 0,
      found: [...down.map((bus) => `${bus.name} ${bus.state}`), ...dirt].join(', ') || (buses.length > 0 ? list(buses.map((bus) => bus.name)) : '…'),
      remedy: 'matchBusesRemedy',
    },
    {
      name: 'matchInput',
      good: !data.conditions.includes('input-open'),
      found: word(data.conditions.includes('input-open') ? 'matchInputOpen' : 'matchInputClosed'),
      remedy: 'matchInputRemedy',
    },
    { name: 'matchEstop', good: data.estop_count > 0, found: `${data.estop_count} ×`, remedy: 'matchEstopRemedy' },
    {
      name: 'matchRealtime',
      good: data.realtime && diagnostics !== null && missed === 0 && notices.length === 0,
      found:
        [
          ...(data.realtime ? [] : [word('notRealtime')]),
          ...(missed > 0 ? [`${word('missed')} ${missed}`] : []),
          ...(notices.length > 0 ? [`${word('notes')} ${notices.length}`] : []),
        ].join(', ') ||
        (diagnostics === null ? '…' : `${word('wake')} p99.9 ${duration(diagnostics.data.wake_latency_us.p999)}`),
      notes: notices,
      remedy: 'matchRealtimeRemedy',
    },
    {
      name: 'matchFile',
      good: isAsCommitted(robot.robot.config_hash, wishes.hash),
      found: robot.robot.config_hash.slice(0, kLeastHashDigits),
      remedy: wishes.hash === '' ? 'matchFileEnter' : 'matchFileRemedy',
    },
  ];
}

/** Text in which `commands` look like what they are. */
function WithCode(props: { text: string }) {
  return <>{props.text.split('`').map((piece, i) => (i % 2 === 0 ? piece : <code key={i}>{piece}</code>))}</>;
}

function Verdict(props: { bad: number; known: Known }) {
  const { word } = useStudio();
  const sure = props.known.connection === 'live' && props.known.state !== null;
  const good = sure && props.bad === 0;
  return (
    <p class={`verdict ${good ? 'good' : 'bad'}`} role="status">
      {good ? `✓ ${word('matchGood')}` : sure ? `✗ ${word('matchBad')} (${props.bad})` : `✗ ${word('matchUnknown')}`}
    </p>
  );
}

/** One page, green or red: whether this robot can go into a match. */
export function Match() {
  const { word } = useStudio();
  const known = useKnown();
  const [hot_c, setHot] = useStored('match.hot_c', kDefaultHot_c);
  const [hash, setHash] = useStored('match.hash', '');
  const [baseline, setBaseline] = useStored<Baseline>('match.baseline', { pid: 0, counts: {} });
  const { robot, state, diagnostics } = known;
  const checks = robot === null || state === null ? [] : checksOf(robot, state, diagnostics, { hot_c, hash, baseline }, word);
  const bad = checks.filter((check) => !check.good).length;
  return (
    <>
      <Verdict bad={bad} known={known} />
      <table class="checks">
        <tbody>
          {checks.map((check) => (
            <tr key={check.name} class={check.good ? 'good' : 'bad'}>
              <td class="sign">{check.good ? '✓' : '✗'}</td>
              <th scope="row">{word(check.name)}</th>
              <td>
                <div class="found">{check.found}</div>
                {!check.good && (
                  <div class="remedy">
                    <WithCode text={word(check.remedy)} />
                  </div>
                )}
                {!check.good && check.notes !== undefined && check.notes.length > 0 && (
                  <details class="notes">
                    <summary>{word('notes')}</summary>
                    {check.notes.map((note) => (
                      <p key={note}>
                        <WithCode text={note} />
                      </p>
                    ))}
                  </details>
                )}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      <div class="toolbar wishes">
        <label>
          {`${word('matchHot')} `}
          <NumberField least={20} value={hot_c} onValue={(wanted) => wanted > 0 && setHot(wanted)} />
          {' °C'}
        </label>
        <label class="hash">
          {`${word('matchHash')} `}
          <input
            value={hash}
            spellcheck={false}
            autocomplete="off"
            placeholder="sha256sum"
            onInput={(event) => setHash(event.currentTarget.value.trim().toLowerCase())}
          />
        </label>
        <button type="button" disabled={robot === null} onClick={() => setHash(robot?.robot.config_hash ?? '')}>
          {word('matchRemember')}
        </button>
        <button
          type="button"
          disabled={robot === null || diagnostics === null}
          onClick={() => {
            if (robot !== null && diagnostics !== null) setBaseline({ pid: robot.robot.pid, counts: countsOf(diagnostics) });
          }}
        >
          {word('matchCount')}
        </button>
      </div>
      <p class="hint">{word('matchHint')}</p>
    </>
  );
}
