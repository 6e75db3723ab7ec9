import { useEffect, useRef, useState } from 'preact/hooks';

import { useKnown, useStudio } from './context';
import type { State } from './protocol';

const kConfirmPatienceMs = 1000;
const kTwiceMs = 600;

type Asked = 'no' | 'asked' | 'unconfirmed';

/** In reach on every part of the page. "Confirmed" is what rc10d's own state says, nothing else. */
export function Stop() {
  const { link, word } = useStudio();
  const known = useKnown();
  const [asked, setAsked] = useState<Asked>('no');
  const timer = useRef(0);
  const lastEscape = useRef(-Infinity);
  const lastPress = useRef(-Infinity);
  const before = useRef<State | null>(null);
  const stopped = known.connection === 'live' && known.state !== null && known.state.data.state !== 'RUN';
  // A robot that stood in ESTOP already: by a state from after the press.
  const confirmed = stopped && (asked === 'no' || known.state !== before.current);

  const press = (event: Event) => {
    lastPress.current = event.timeStamp;
    before.current = link.known.state;
    void link.ask({ operation: 'estop' });
    setAsked('asked');
    clearTimeout(timer.current);
    timer.current = window.setTimeout(() => setAsked('unconfirmed'), kConfirmPatienceMs);
  };

  useEffect(() => {
    if (!confirmed) return;
    clearTimeout(timer.current);
    setAsked('no');
  }, [confirmed, asked]);

  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      if (event.key !== 'Escape' || event.repeat) return;
      if (event.timeStamp - lastEscape.current < kTwiceMs) press(event);
      lastEscape.current = event.timeStamp;
    };
    window.addEventListener('keydown', onKey, { capture: true });
    return () => window.removeEventListener('keydown', onKey, { capture: true });
  });

  return (
    <div class="stop">
      <button
        type="button"
        class="stop-button"
        title={word('stopHint')}
        onPointerDown={press}
        onKeyDown={(event) => (event.key === 'Enter' || event.key === ' ') && !event.repeat && press(event)}
        // A screen reader or a voice clicks without a pointer or a key before.
        onClick={(event) => event.timeStamp - lastPress.current > kTwiceMs && press(event)}
      >
        {word('stop')}
      </button>
      <span class={`stop-told ${confirmed ? 'no' : asked}`} role="status" aria-live="assertive">
        {confirmed ? word('stopConfirmed') : asked === 'unconfirmed' ? word('stopUnconfirmed') : asked === 'asked' ? word('stopAsked') : ''}
      </span>
    </div>
  );
}
