// A hold: something moves only while one pointer or one key is down. Any other ends it.
import { useEffect, useRef } from 'preact/hooks';

/** Released; another pointer or key; or the window or the motor was left. */
export type HoldEnd = 'released' | 'other' | 'left';

/** `onEnd`: once for each hold, unless clear() has come first. */
export function useHold(motor: string, onEnd: (why: HoldEnd) => void) {
  const pointer = useRef<number | null>(null);
  const key = useRef('');
  // The pointer or key that ended a hold begins none.
  const ended = useRef(0);
  const report = useRef(onEnd);
  report.current = onEnd;

  const byKey = () => key.current !== '';
  const held = () => pointer.current !== null || byKey();
  const clear = () => {
    pointer.current = null;
    key.current = '';
  };
  const end = (why: HoldEnd) => {
    if (!held()) return;
    clear();
    report.current(why);
  };

  useEffect(() => {
    const left = () => end('left');
    const other = (event: Event) => {
      if (!held()) return;
      ended.current = event.timeStamp;
      end('other');
    };
    const keyDown = (event: KeyboardEvent) => {
      if (!event.repeat && event.key !== key.current) other(event);
    };
    // Any key, wherever the focus has gone.
    const keyUp = () => byKey() && end('released');
    const options = { capture: true };
    window.addEventListener('blur', left);
    window.addEventListener('pointerdown', other, options);
    window.addEventListener('keydown', keyDown, options);
    window.addEventListener('keyup', keyUp, options);
    return () => {
      left();
      window.removeEventListener('blur', left);
      window.removeEventListener('pointerdown', other, options);
      window.removeEventListener('keydown', keyDown, options);
      window.removeEventListener('keyup', keyUp, options);
    };
  }, [motor]);

  return {
    held,
    byKey,
    end,
    /** Ends it without a report. */
    clear,
    /** Handlers of a button; `begin` returns whether a hold began. */
    pointerHandlers: (begin: () => boolean) => ({
      onPointerDown: (event: PointerEvent & { currentTarget: HTMLElement }) => {
        if (!event.isPrimary || event.button !== 0 || event.timeStamp === ended.current) return;
        event.currentTarget.setPointerCapture(event.pointerId);
        if (held()) return end('other');
        pointer.current = event.pointerId;
        if (!begin()) clear();
      },
      // With another button of the mouse down, no pointerup tells that this one came up.
      onPointerMove: (event: PointerEvent) => {
        if (pointer.current === event.pointerId && event.buttons !== 1) end('released');
      },
      onPointerUp: () => end('released'),
      onPointerCancel: () => end('left'),
      onLostPointerCapture: () => end('released'),
      onContextMenu: (event: Event) => event.preventDefault(),
    }),
    /** A key that holds has gone down. */
    beginByKey: (event: KeyboardEvent, begin: () => boolean) => {
      event.preventDefault();
      if (event.repeat || held() || event.timeStamp === ended.current) return;
      key.current = event.key;
      if (!begin()) clear();
    },
  };
}
