// The two steps of commissioning that move the motor: it is enabled alone, and moves while a button is held.
import { useEffect, useRef, useState } from 'preact/hooks';

import { CopyLines, requestPython } from './action';
import { useKnown, useStudio } from './context';
import { HeldTest } from './held_test';
import type { TestOutcome } from './link';
import { type TestPlan, testCommand, testPython } from './motion_test';
import { isOn } from './commission_record';
import { kAtEnd, kDisableAtEnd } from './protocol';
import { Refusal } from './refusal';

export function AloneTest(props: {
  motor: string;
  plan: TestPlan;
  label: string;
  /** CheckedMotor.untested_loops; null: not known. */
  loops: string[] | null;
  onOutcome: (outcome: TestOutcome) => void;
}) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [told, setTold] = useState('');
  const [busy, setBusy] = useState(false);
  const [alone, setAlone] = useState(false);
  const mine = useRef(false);
  const motor = known.state?.data.motors.find((each) => each.name === props.motor);
  const mayCommand = known.hello?.right === 'command' && known.state !== null;

  const ask = async (operation: 'enable_alone' | 'disable', values: Record<string, number> = {}) => {
    setBusy(true);
    if (operation === 'enable_alone') mine.current = true;
    const answer = await link.ask({ operation, target: props.motor, values });
    setBusy(false);
    mine.current = answer.status === 'ok' && operation === 'enable_alone';
    setAlone(mine.current);
    setTold(answer.status === 'ok' ? '' : answer.message);
  };
  // Lost, disabled by another, a fault: the lock is over.
  const on = isOn(motor);
  useEffect(() => {
    if (on || busy) return;
    mine.current = false;
    setAlone(false);
  }, [on]);
  // Another step, part or motor: it does not stay enabled behind them.
  useEffect(
    () => () => {
      if (mine.current) void link.ask({ operation: 'disable', target: props.motor, values: kAtEnd });
      mine.current = false;
    },
    [props.motor],
  );
  // Once: a second disable would let go of what its on_disable holds, or an e-stop.
  const rest = () => {
    if (!mine.current) return;
    mine.current = false;
    void ask('disable', kAtEnd);
  };

  if (props.loops !== null && props.loops.length > 0) {
    return (
      <p class="notice" role="alert">
        {`${word('comLoopActs')} `}
        <code>{props.loops.join(', ')}</code>
        {`. ${word('comLoopActsMend')} `}
        <code>{props.loops.map((line) => line.replace(/:.*/, ': coast')).join(', ')}</code>
      </p>
    );
  }
  return (
    <>
      {props.loops === null && <p class="notice">{word('comLoopsUnknown')}</p>}
      <div class="toolbar">
        {on ? (
          <button type="button" disabled={!mayCommand} onClick={() => void ask('disable')}>
            {word('disable')}
          </button>
        ) : (
          <button type="button" class="strong" disabled={!mayCommand || busy} onClick={() => void ask('enable_alone', kDisableAtEnd)}>
            {word('comAlone')}
          </button>
        )}
        <CopyLines
          request={{ operation: 'enable_alone', target: props.motor }}
          command={`rc10ctl commission ${props.motor}`}
          python={requestPython({ operation: 'enable_alone', target: props.motor })}
        />
        {on && <span class="badge limit">{word(alone ? 'comAloneNow' : 'comNotAlone')}</span>}
        <Refusal why={told} />
      </div>
      <div class="toolbar">
        <HeldTest
          motor={props.motor}
          plan={props.plan}
          label={props.label}
          ready={alone && motor?.status === 'ACTIVE'}
          onLetGo={rest}
          onEnd={(outcome) => {
            rest();
            props.onOutcome(outcome);
          }}
        />
        <CopyLines
          request={{ operation: 'test', target: props.motor }}
          command={testCommand(props.motor, props.plan)}
          python={testPython(props.motor, props.plan)}
        />
      </div>
      <p class="hint">
        <code>{testCommand(props.motor, props.plan)}</code>
      </p>
      <p class="hint">{word('comAloneHint')}</p>
    </>
  );
}
