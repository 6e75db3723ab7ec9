import { useState } from 'preact/hooks';

import { useKnown, useStudio } from './context';
import type { RobotRequest } from './link';

/** The line in a terminal that does the same. */
export function commandOf(request: RobotRequest): string {
  const target = request.target === undefined || request.target === '' ? '' : ` ${request.target.replaceAll(',', ' ')}`;
  return `rc10ctl ${request.operation}${target}`;
}

/** A button that asks rc10d for something and says what it answered. */
export function Action(props: { request: RobotRequest; label: string; strong?: boolean }) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [told, setTold] = useState<{ status: string; message: string } | null>(null);
  const [busy, setBusy] = useState(false);
  const allowed = known.hello?.right === 'command' && known.state !== null;

  const ask = async () => {
    setBusy(true);
    const answer = await link.ask(props.request);
    setBusy(false);
    setTold(answer.status === 'ok' ? null : answer);
  };

  return (
    <span class="action">
      <button
        type="button"
        class={props.strong === true ? 'strong' : ''}
        disabled={!allowed || busy}
        title={allowed ? commandOf(props.request) : word('lookOnly')}
        onClick={() => void ask()}
      >
        {props.label}
      </button>
      <button
        type="button"
        class="copy"
        title={`${word('copy')}: ${commandOf(props.request)}`}
        aria-label={`${word('copy')}: ${commandOf(props.request)}`}
        onClick={() => void navigator.clipboard?.writeText(commandOf(props.request))}
      >
        <svg viewBox="0 0 16 16" aria-hidden="true">
          <rect x="5" y="5" width="9" height="9" rx="1.5" />
          <path d="M11 5V3.5A1.5 1.5 0 0 0 9.5 2h-6A1.5 1.5 0 0 0 2 3.5v6A1.5 1.5 0 0 0 3.5 11H5" />
        </svg>
      </button>
      {told !== null && (
        <span class="refused" role="alert" onClick={() => setTold(null)}>
          {told.message}
        </span>
      )}
    </span>
  );
}
