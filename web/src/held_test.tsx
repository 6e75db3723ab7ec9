// A test of motion that goes on only while a button or a key is held.
import { useEffect, useRef, useState } from 'preact/hooks';

import { useKnown, useStudio } from './context';
import type { TestOutcome } from './link';
import { type TestPlan, planOf } from './motion_test';

type End = (why: 'stopped' | 'left') => void;

/** Its motor is ACTIVE when it begins; `onLetGo`: at once, before the numbers; `onEnd`: it is over, or did not begin. */
export function HeldTest(props: { motor: string; plan: TestPlan; label: string; ready: boolean; onLetGo: () => void; onEnd: (outcome: TestOutcome) => void }) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [time, setTime] = useState<string | null>(null);
  const end = useRef<End | null>(null);
  const heldKey = useRef('');
  const onLetGo = useRef(props.onLetGo);
  onLetGo.current = props.onLetGo;
  // The pointer or key that ended a hold begins none.
  const ended = useRef(0);
  const allowed = props.ready && known.hello?.right === 'command' && known.connection === 'live';

  const letGo = (why: 'stopped' | 'left') => {
    heldKey.current = '';
    if (end.current === null) return;
    end.current(why);
    onLetGo.current();
  };

  const begin = async () => {
    if (end.current !== null || !allowed) return;
    setTime('');
    const test = link.runTest({ motor: props.motor, ...planOf(props.plan) }, (time_s, lasts_s) =>
      setTime(`${time_s.toFixed(1)} / ${lasts_s.toFixed(1)} s`),
    );
    end.current = test.end;
    const outcome = await test.outcome;
    end.current = null;
    heldKey.current = '';
    setTime(null);
    props.onEnd(outcome);
  };

  useEffect(() => {
    const left = () => letGo('left');
    const other = (event: Event) => {
      if (end.current === null) return;
      ended.current = event.timeStamp;
      letGo('stopped');
    };
    const key = (event: KeyboardEvent) => {
      if (!event.repeat && event.key !== heldKey.current) other(event);
    };
    const keyUp = () => heldKey.current !== '' && letGo('stopped');
    const options = { capture: true };
    window.addEventListener('blur', left);
    window.addEventListener('pointerdown', other, options);
    window.addEventListener('keydown', key, options);
    window.addEventListener('keyup', keyUp, options);
    return () => {
      left();
      window.removeEventListener('blur', left);
      window.removeEventListener('pointerdown', other, options);
      window.removeEventListener('keydown', key, options);
      window.removeEventListener('keyup', keyUp, options);
    };
  }, [props.motor]);

  return (
    <>
      <button
        type="button"
        class={`jog hold ${time === null ? '' : 'held'}`}
        disabled={!allowed}
        onPointerDown={(event) => {
          if (!event.isPrimary || event.button !== 0 || event.timeStamp === ended.current) return;
          event.currentTarget.setPointerCapture(event.pointerId);
          void begin();
        }}
        // With another button of the mouse down, no pointerup tells that this one came up.
        onPointerMove={(event) => end.current !== null && heldKey.current === '' && event.buttons !== 1 && letGo('stopped')}
        onPointerUp={() => letGo('stopped')}
        onPointerCancel={() => letGo('left')}
        onLostPointerCapture={() => letGo('stopped')}
        onContextMenu={(event) => event.preventDefault()}
        onKeyDown={(event) => {
          if (event.key !== ' ' && event.key !== 'Enter') return;
          event.preventDefault();
          if (event.repeat || end.current !== null || event.timeStamp === ended.current) return;
          heldKey.current = event.key;
          void begin();
        }}
        onBlur={() => letGo('stopped')}
      >
        {props.label}
      </button>
      <span class="hint" role="timer">
        {time === null ? word('comHold') : time}
      </span>
    </>
  );
}
