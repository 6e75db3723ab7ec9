// Gains of the loops that rc10d closes: live, with what they were before, and the lines for the robot's file.
import { useEffect, useRef, useState } from 'preact/hooks';

import { CopyLines } from './action';
import { CopyButton } from './clipboard';
import { putIntoDraft } from './config_draft';
import { useKnown, useStoredOfRobot, useStudio } from './context';
import { NumberField } from './number_field';
import { withMotorLoops } from './yaml_motor';

type Values = Record<string, number>;

// docs/lcm.md
const kGainChanged = 110;

const same = (a: Values, b: Values) => Object.keys(a).every((key) => a[key] === b[key]);

/** A change, with what was in force before it of the same gains: others may be changed by somebody else. */
interface Change {
  at: string;
  /** Process of rc10d: another one has the gains of its file. */
  pid: number;
  before: Values;
  set: Values;
}
const kMostChanges = 20;

const listed = (values: Values) =>
  Object.entries(values)
    .map(([key, value]) => `${key}=${value}`)
    .join(' ');

/** `proposed`: values that are entered, and not in force until they are applied; `onKnown`: the gains in force, null of a motor
 * whose drive closes its loops. */
export function Gains(props: { motor: string; proposed?: Values | null; onKnown?: (values: Values | null) => void }) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [inForce, setInForce] = useState<Values | null>(null);
  const [wanted, setWanted] = useState<Values>({});
  const [changes, setHistory] = useStoredOfRobot<Change[]>(`gains/${props.motor}`, []);
  const [yaml, setYaml] = useState('');
  const [told, setTold] = useState('');
  // A reading that is under way must not take away the answer to a request.
  const [notRead, setNotRead] = useState('');
  // Keys with text of a person, or of a proposal, that is not in force.
  const entered = useRef(new Set<string>());
  const allowed = known.hello?.right === 'command';
  // Told by another page or program, or another rc10d: what is shown here may be old.
  const told_us = known.events.find((event) => event.code === kGainChanged && event.source === props.motor)?.mono_us;
  const robot = known.robot;
  const pid = robot?.robot.pid ?? 0;
  const history = changes.filter((change) => change.pid === pid);

  const load = async () => {
    const answer = await link.ask({ operation: 'get_config', target: props.motor });
    if (answer.status !== 'ok') {
      setInForce(null);
      setNotRead(answer.message);
      if (answer.status === 'refused') props.onKnown?.(null);
      return;
    }
    setNotRead('');
    // Text that was entered meanwhile stays, also if it was in force for a while.
    setWanted((typed) =>
      Object.fromEntries(
        Object.entries(answer.values).map(([key, value]) => {
          const text = entered.current.has(key) ? (typed[key] ?? value) : value;
          if (text === value) entered.current.delete(key);
          return [key, text];
        }),
      ),
    );
    setInForce(answer.values);
    setYaml(answer.message);
    props.onKnown?.(answer.values);
  };
  useEffect(() => setTold(''), [props.motor]);
  useEffect(() => {
    if (allowed) void load();
  }, [props.motor, allowed, robot, told_us]);

  useEffect(() => {
    if (!props.proposed) return;
    for (const key of Object.keys(props.proposed)) entered.current.add(key);
    setWanted((typed) => ({ ...typed, ...props.proposed }));
  }, [props.proposed]);

  const changed = (values: Values) =>
    Object.fromEntries(Object.entries(values).filter(([key, value]) => inForce?.[key] !== value));
  const set = async (values: Values, then: () => void) => {
    setTold('');
    // Nothing: somebody else has set them so.
    if (!same(values, inForce ?? {})) {
      const answer = await link.ask({ operation: 'set_gains', target: props.motor, values: changed(values) });
      if (answer.status !== 'ok') return setTold(answer.message);
    }
    then();
    await load();
  };

  /** Gains in force before the change at this place: those that it and later ones have changed. */
  const beforeOf = (i: number): Values => Object.assign({}, ...history.slice(0, i + 1).map((change) => change.before));
  const back = (i: number) => void set(beforeOf(i), () => setHistory(history.slice(i + 1)));

  const put = async () => {
    setTold('');
    // Those in force now: an answer may be under way that changes what is shown.
    const [file, gains] = await Promise.all([link.config(), link.ask({ operation: 'get_config', target: props.motor })]);
    if (typeof file === 'string' || file.config.why !== '') return setTold(typeof file === 'string' ? file : file.config.why);
    if (gains.status !== 'ok') return setTold(gains.message);
    const change = (text: string) => withMotorLoops(text, props.motor, gains.message);
    if (!putIntoDraft(file.config.text, change, `${word('gains')}: ${props.motor}`)) setTold(word('comNotPut'));
  };

  return (
    <section class="card gains" aria-label={word('gains')}>
      <h3>{word('gains')}</h3>
      {inForce !== null && (
        <form
          onSubmit={(event) => {
            event.preventDefault();
            const of = changed(wanted);
            const before = Object.fromEntries(Object.keys(of).map((key) => [key, inForce[key] ?? NaN]));
            const change = { at: new Date().toISOString(), pid, before, set: of };
            void set(wanted, () => setHistory([change, ...history].slice(0, kMostChanges)));
          }}
        >
          <table>
            <tbody>
              {Object.entries(inForce).map(([key, value]) => (
                <tr key={key}>
                  <th scope="row">
                    <label for={`gain-${key}`}>{key}</label>
                  </th>
                  <td>
                    <NumberField
                      id={`gain-${key}`}
                      changed={wanted[key] !== value}
                      value={wanted[key] ?? value}
                      onValue={(number) => {
                        entered.current.add(key);
                        setWanted({ ...wanted, [key]: number });
                      }}
                    />
                  </td>
                </tr>
              ))}
            </tbody>
          </table>
          <div class="toolbar">
            <button type="submit" class="strong" disabled={!allowed || same(inForce, wanted)}>
              {word('gainsApply')}
            </button>
            <button
              type="button"
              disabled={!allowed || history.length === 0}
              onClick={() => back(0)}
            >
              {`${word('gainsUndo')}${history.length > 0 ? ` (${history.length})` : ''}`}
            </button>
            <CopyLines
              request={{ operation: 'set_gains', target: props.motor, values: changed(wanted) }}
              command={`rc10ctl gains ${props.motor} ${listed(changed(wanted))}`.trim()}
            />
            <CopyButton text={yaml}>{word('gainsCopy')}</CopyButton>
            <button type="button" onClick={() => void put()}>
              {word('comPut')}
            </button>
          </div>
          <details>
            <summary>{word('gainsLines')}</summary>
            <pre>{yaml}</pre>
          </details>
          {history.length > 0 && (
            <details>
              <summary>{word('gainsHistory')}</summary>
              <ol class="history">
                {history.map((change, i) => (
                  <li key={change.at}>
                    <span class="hint">{new Date(change.at).toLocaleTimeString()}</span>
                    {` ${listed(change.set)} `}
                    <button
                      type="button"
                      disabled={!allowed}
                      title={listed(beforeOf(i))}
                      onClick={() => back(i)}
                    >
                      {word('gainsBefore')}
                    </button>
                  </li>
                ))}
              </ol>
            </details>
          )}
        </form>
      )}
      {/* The notice of the page tells the end of rc10d, once. */}
      {notRead !== '' && known.down === null && (
        <p class="hint" role="alert">
          {notRead}
        </p>
      )}
      {notRead === '' && told !== '' && (
        <p class="refused" role="alert">
          {told}
        </p>
      )}
    </section>
  );
}
