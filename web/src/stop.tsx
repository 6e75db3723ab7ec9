import { useEffect, useRef, useState } from 'preact/hooks';

import { useKnown, useStudio } from './context';

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
  const stopped = known.connection === 'live' && known.state !== null && known.state.data.state !== 'RUN';

  const press = () => {
    void link.ask({ operation: 'estop' });
    setAsked('asked');
    clearTimeout(timer.current);
    timer.current = window.setTimeout(() => setAsked('unconfirmed'), kConfirmPatienceMs);
  };

  useEffect(() => {
    if (!stopped) return;
    clearTimeout(timer.current);
    setAsked('no');
  }, [stopped]);

  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      if (event.key !== 'Escape' || event.repeat) return;
      if (event.timeStamp - lastEscape.current < kTwiceMs) press();
      lastEscape.current = event.timeStamp;
    };
    window.addEventListener('keydown', onKey, { capture: true });
    return () => window.removeEventListener('keydown', onKey, { capture: true });
  });

  return (
    <div class="stop">
      <button type="button" class="stop-button" title={word('stopHint')} onPointerDown={press} onKeyDown={(e) => e.key === 'Enter' && press()}>
        {word('stop')}
      </button>
      <span class={`stop-told ${asked}`} role="status" aria-live="assertive">
        {asked === 'unconfirmed' ? word('stopUnconfirmed') : stopped ? word('stopConfirmed') : asked === 'asked' ? word('stopAsked') : ''}
      </span>
    </div>
  );
}
