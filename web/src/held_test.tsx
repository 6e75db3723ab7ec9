// A test of motion that goes on only while a button or a key is held.
import { useRef, useState } from 'preact/hooks';

import { useKnown, useStudio } from './context';
import { useHold } from './hold';
import type { TestOutcome } from './link';
import { type TestPlan, planOf } from './motion_test';

/** Its motor is ACTIVE when it begins; `onLetGo`: at once, before the numbers; `onEnd`: it is over, or did not begin. */
export function HeldTest(props: { motor: string; plan: TestPlan; label: string; ready: boolean; onLetGo: () => void; onEnd: (outcome: TestOutcome) => void }) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [time, setTime] = useState<string | null>(null);
  // The way to end the test that runs, until its outcome is known.
  const endTest = useRef<((why: 'stopped' | 'left') => void) | null>(null);
  const allowed = props.ready && known.hello?.right === 'command' && known.connection === 'live';
  const hold = useHold(props.motor, (why) => {
    endTest.current?.(why === 'left' ? 'left' : 'stopped');
    props.onLetGo();
  });

  const run = async () => {
    setTime('');
    const test = link.runTest({ motor: props.motor, ...planOf(props.plan) }, (time_s, lasts_s) =>
      setTime(`${time_s.toFixed(1)} / ${lasts_s.toFixed(1)} s`),
    );
    endTest.current = test.end;
    const outcome = await test.outcome;
    endTest.current = null;
    hold.clear();
    setTime(null);
    props.onEnd(outcome);
  };
  const begin = () => {
    if (endTest.current !== null || !allowed) return false;
    void run();
    return true;
  };

  return (
    <>
      <button
        type="button"
        class={`jog hold ${time === null ? '' : 'held'}`}
        disabled={!allowed}
        {...hold.pointerHandlers(begin)}
        onKeyDown={(event) => {
          if (event.key === ' ' || event.key === 'Enter') hold.beginByKey(event, begin);
        }}
        onBlur={() => hold.end('released')}
      >
        {props.label}
      </button>
      <span class="hint" role="timer">
        {time === null ? word('comHold') : time}
      </span>
    </>
  );
}
