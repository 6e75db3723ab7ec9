// The steps of commissioning that need a hand or a look, and no torque.
import { useEffect, useRef, useState } from 'preact/hooks';

import { CopyLines, requestPython } from './action';
import type { StepProps } from './commission';
import { absoluteZero, angles, hasLostItsAngle, isOn, judgeHandTurn, judgeLimits, turnRange } from './commission_record';
import { BusScan } from './commission_scan';
import { useKnown, useStudio } from './context';
import type { RobotRequest } from './link';
import { NumberField } from './number_field';
import { duration, number } from './numbers';
import type { CheckedConfig, MotorState } from './protocol';
import { Refusal } from './refusal';
import { filled } from './words_commission';

type Robot = NonNullable<CheckedConfig['checked']['robot']>;

function useMotors() {
  return useKnown().state?.data.motors ?? [];
}

// A page is some states behind: an angle that it reads while the shaft turns is an old one.
const kStillRpm = 3;
const isStill = (motor: MotorState | undefined) => Math.abs(motor?.velocity_rpm ?? 0) < kStillRpm;

/** A terminal's line for the same. */
function Line(props: { command: string; request: RobotRequest }) {
  return (
    <p class="hint no-print">
      <code>{props.command}</code>
      <CopyLines request={props.request} command={props.command} python={requestPython(props.request)} />
    </p>
  );
}

/** The hand of a simulated motor, by explicit presses. */
function SimulatedHand(props: { motor: string; by: number[] }) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [told, setTold] = useState('');
  if (known.state?.data.conditions.includes('simulated') !== true) return null;
  const turn = async (by_deg: number) => {
    const answer = await link.ask({ operation: 'hand', target: props.motor, values: { by_deg, speed_rpm: 60 } });
    setTold(answer.status === 'ok' ? '' : answer.message);
  };
  return (
    <>
      <div class="toolbar">
        <span class="hint">{word('comSimulatedHand')}</span>
        {props.by.map((deg) => (
          <button type="button" key={deg} disabled={known.hello?.right !== 'command'} onClick={() => void turn(deg)}>
            {`${deg > 0 ? '+' : '−'}${Math.abs(deg)}°`}
          </button>
        ))}
        <Refusal why={told} />
      </div>
      <Line
        command={`rc10ctl hand ${props.motor} --by ${props.by[0] ?? 90}`}
        request={{ operation: 'hand', target: props.motor, values: { by_deg: props.by[0] ?? 90 } }}
      />
    </>
  );
}

export function BusStep(props: StepProps & { bus: string; id: number; robot: Robot | null; text: string | null }) {
  const { word } = useStudio();
  const known = useKnown();
  const motors = useMotors();
  const plan = props.robot?.buses.find((each) => each.name === props.bus);
  const infos = (known.robot?.robot.motors ?? []).filter((each) => each.bus === props.bus);
  const bus = known.diagnostics?.data.buses.find((each) => each.name === props.bus);
  const motor = motors.find((each) => each.name === props.motor);
  const expected = Number(/ at (\d+) Hz$/.exec(props.checked?.feedback ?? '')?.[1] ?? NaN);
  const complaints: string[] = [];
  if (motor === undefined || motor.status === 'OFFLINE') complaints.push(word('comBusSilent'));
  // Two drives with one id speak twice as often.
  if ((motor?.feedback_hz ?? 0) > 1.5 * expected) complaints.push(filled(word('comBusTwice'), { hz: number(motor?.feedback_hz, 0), expected: String(expected) }));
  if ((bus?.rx_unmatched ?? 0) > 0) complaints.push(filled(word('comBusUnmatched'), { frames: String(bus?.rx_unmatched ?? 0) }));
  if ((bus?.rx_foreign ?? 0) > 0) complaints.push(filled(word('comBusForeign'), { frames: String(bus?.rx_foreign ?? 0) }));
  if ((bus?.error_frames ?? 0) > 0) complaints.push(filled(word('comBusErrors'), { frames: String(bus?.error_frames ?? 0) }));
  const heard = motor !== undefined && motor.status !== 'OFFLINE';
  return (
    <>
      <p>{word('comBusText')}</p>
      <div class="scroll" tabIndex={0} role="group" aria-label={props.bus}>
        <table class="timing">
          <thead>
            <tr>
              <th scope="col">{word('motor')}</th>
              <th scope="col">model</th>
              <th scope="col" class="number">
                id
              </th>
              <th scope="col">{word('configFeedback')}</th>
              <th scope="col">{word('configCommand')}</th>
              <th scope="col" class="number">
                Hz
              </th>
              <th scope="col">{word('age')}</th>
              <th scope="col">status</th>
            </tr>
          </thead>
          <tbody>
            {infos.map((each) => {
              const ids = plan?.motors.find((one) => one.name === each.name);
              const state = motors.find((one) => one.name === each.name);
              return (
                <tr key={each.name} aria-current={each.name === props.motor ? 'true' : undefined}>
                  <th scope="row">{each.name}</th>
                  <td>{each.model}</td>
                  <td class="number">{each.id}</td>
                  <td>{ids?.feedback ?? '–'}</td>
                  <td>{ids?.command ?? '–'}</td>
                  <td class="number">{number(state?.feedback_hz, 0)}</td>
                  <td>{duration(state?.feedback_age_us ?? -1)}</td>
                  <td>{state?.status ?? '–'}</td>
                </tr>
              );
            })}
          </tbody>
        </table>
      </div>
      {complaints.length > 0 && (
        <ul class="notice">
          {complaints.map((complaint) => (
            <li key={complaint}>{complaint}</li>
          ))}
        </ul>
      )}
      <BusScan bus={props.bus} motor={props.motor} text={props.text} />
      <div class="toolbar">
        <button
          type="button"
          class="strong"
          disabled={!heard}
          onClick={() =>
            props.onFound('bus', {
              good: true,
              word: complaints.length === 0 ? 'comBusGood' : 'comBusWarned',
              values: { motor: props.motor, id: String(props.id), bus: props.bus, feedback: props.checked?.feedback ?? '?', command: props.checked?.command ?? '?', complaints: complaints.join(' ') },
            })
          }
        >
          {filled(word('comBusConfirm'), { id: String(props.id) })}
        </button>
      </div>
    </>
  );
}

export function HandStep(props: StepProps) {
  const { link, word } = useStudio();
  const motors = useMotors();
  const [before, setBefore] = useState<Record<string, number> | null>(null);
  const begun_us = useRef(0);
  const motor = motors.find((each) => each.name === props.motor);
  const turned = before === null ? null : (motor?.total_angle_deg ?? NaN) - (before[props.motor] ?? NaN);
  const ready = motor !== undefined && motor.status !== 'OFFLINE' && !motors.some(isOn) && motors.every(isStill);
  return (
    <>
      <p>{word('comHandText')}</p>
      <div class="toolbar">
        {before === null ? (
          <button type="button" class="strong" disabled={!ready} onClick={() => {
              begun_us.current = link.known.state?.data.mono_us ?? 0;
              setBefore(angles(motors));
            }}
          >
            {word('comHandBegin')}
          </button>
        ) : (
          <>
            <button
              type="button"
              class="strong"
              disabled={!ready}
              onClick={() => {
                props.onFound('hand', judgeHandTurn(props.motor, before, angles(motors), props.checked, hasLostItsAngle(link.known.events, props.motor, begun_us.current)));
                setBefore(null);
              }}
            >
              {word('comHandDone')}
            </button>
            <strong class="live-angle">{`${number(turned)}°`}</strong>
          </>
        )}
      </div>
      <SimulatedHand motor={props.motor} by={[360, 90, -90]} />
      <p class="hint no-print">
        <code>{`rc10ctl commission ${props.motor} --limit ${props.record.current_a}A`}</code>
      </p>
    </>
  );
}

export function ZeroStep(props: StepProps) {
  const { link, word } = useStudio();
  const known = useKnown();
  const motor = useMotors().find((each) => each.name === props.motor);
  const [told, setTold] = useState('');
  const { record, checked } = props;
  const absolute = absoluteZero(checked);
  const now_deg = motor?.total_angle_deg ?? null;
  const zero = async () => {
    const answer = await link.ask({ operation: 'zero', target: props.motor, values: { angle_deg: record.zero_deg } });
    setTold(answer.status === 'ok' ? '' : answer.message);
    if (answer.status !== 'ok') return;
    // rc10d says it for an absolute encoder: somebody may have set the angle before.
    const zero_deg = answer.values?.zero_deg;
    props.onFound('zero', {
      good: true,
      word: zero_deg === undefined ? 'comZeroGood' : 'comZeroAbsolute',
      values: { motor: props.motor, before: number(now_deg), deg: number(record.zero_deg) },
      ...(zero_deg === undefined ? {} : { lines: { zero_deg } }),
    });
  };
  const kind = absolute !== null ? word('comZeroIsAbsolute') : checked?.zero === 'at power-on' ? word('comZeroIsPowerOn') : word('comZeroIsRequest');
  return (
    <>
      <p>{word('comZeroText')}</p>
      <p>
        <strong class="live-angle">{`${number(now_deg)}°`}</strong>
        {` ${motor?.zeroed === true ? word('comZeroed') : word('notReferenced')}`}
      </p>
      <p class="notice">{kind}</p>
      <div class="toolbar">
        <label>
          {`${word('comZeroIs')} `}
          <NumberField label={word('comZeroIs')} value={record.zero_deg} onValue={(value) => props.onSet({ zero_deg: value })} />
          {' °'}
        </label>
        <button type="button" class="strong" disabled={known.hello?.right !== 'command' || motor === undefined || isOn(motor) || !isStill(motor)} onClick={() => void zero()}>
          {word('comZero')}
        </button>
        <button
          type="button"
          disabled={motor?.zeroed !== true}
          onClick={() => props.onFound('zero', { good: true, word: 'comZeroStays', values: { motor: props.motor, deg: number(now_deg) } })}
        >
          {word('comZeroKeep')}
        </button>
        <Refusal why={told} />
      </div>
      <SimulatedHand motor={props.motor} by={[10, -10]} />
      <Line
        command={`rc10ctl zero ${props.motor} ${record.zero_deg}`}
        request={{ operation: 'zero', target: props.motor, values: { angle_deg: record.zero_deg } }}
      />
    </>
  );
}

export function LimitsStep(props: StepProps) {
  const { word } = useStudio();
  const motor = useMotors().find((each) => each.name === props.motor);
  const { record } = props;
  const now_deg = motor?.total_angle_deg ?? null;
  const ready = now_deg !== null && motor?.zeroed === true && !isOn(motor) && isStill(motor);
  const end = (key: 'low_deg' | 'high_deg') => now_deg !== null && props.onSet({ [key]: Number(now_deg.toFixed(2)) });
  const { low_deg: low, high_deg: high } = record;
  // Without its reference the ends that were taken mean nothing any more.
  const unknown = motor !== undefined && motor.zeroed !== true;
  useEffect(() => {
    if (unknown && (low !== null || high !== null)) props.onSet({ low_deg: null, high_deg: null });
  }, [unknown, low, high]);
  const range = turnRange(record.lines.angle_min_deg, record.lines.angle_max_deg);
  return (
    <>
      <p>{word('comLimitsText')}</p>
      <p>
        <strong class="live-angle">{`${number(now_deg)}°`}</strong>
        {motor?.zeroed === true ? '' : ` ${word('notReferenced')}`}
      </p>
      <div class="toolbar">
        <button type="button" disabled={!ready} onClick={() => end('low_deg')}>
          {`${word('comLow')}${low === null ? '' : ` (${number(low)}°)`}`}
        </button>
        <button type="button" disabled={!ready} onClick={() => end('high_deg')}>
          {`${word('comHigh')}${high === null ? '' : ` (${number(high)}°)`}`}
        </button>
        <label>
          {`${word('comMargin')} `}
          <NumberField label={word('comMargin')} value={record.margin_deg} least={0} onValue={(value) => props.onSet({ margin_deg: Math.abs(value) })} />
          {' °'}
        </label>
      </div>
      <div class="toolbar">
        <button
          type="button"
          class="strong"
          disabled={low === null || high === null}
          onClick={() => low !== null && high !== null && props.onFound('limits', judgeLimits(low, high, record.margin_deg))}
        >
          {word('comLimitsTake')}
        </button>
        <button
          type="button"
          onClick={() => {
            props.onSet({ low_deg: null, high_deg: null });
            props.onFound('limits', { good: true, word: 'comLimitsSkipped', values: { motor: props.motor } });
          }}
        >
          {word('comLimitsSkip')}
        </button>
      </div>
      {record.lines.angle_min_deg !== undefined && absoluteZero(props.checked) !== null && (
        <p class="notice">
          {range === null ? word('comTurnUnknown') : filled(word('comTurnKnown'), { from: number(range[0], 0), to: number(range[1], 0) })}
        </p>
      )}
      <SimulatedHand motor={props.motor} by={[90, 15, -15, -90]} />
      <p class="hint no-print">
        <code>rc10ctl watch --count 1</code>
      </p>
    </>
  );
}
