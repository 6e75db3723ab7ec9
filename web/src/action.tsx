import { useState } from 'preact/hooks';

import { CopyButton } from './clipboard';
import { useKnown, useStudio } from './context';
import type { RobotRequest } from './link';

/** The line in a terminal that does the same. */
export function commandOf(request: RobotRequest): string {
  const target = request.target === undefined || request.target === '' ? '' : ` ${request.target.replaceAll(',', ' ')}`;
  return `rc10ctl ${request.operation}${target}`;
}

/** The line of a Python program that does the same, with `robot = rc10.connect(...)`. */
export function pythonOf(request: RobotRequest): string {
  const names = (request.target ?? '').split(',').filter((name) => name !== '').map((name) => `"${name}"`);
  const values = Object.entries(request.values ?? {}).map(([key, value]) => `"${key}": ${value}`);
  const last = values.length === 0 ? [] : [`{${values.join(', ')}}`];
  return `robot.${request.operation}(${[...names, ...last].join(', ')})`;
}

/** The same for an operation that has no method of its own. */
export function requestPython(request: RobotRequest): string {
  const values = Object.entries(request.values ?? {}).map(([key, value]) => `"${key}": ${value}`);
  return `robot.request("${request.operation}", "${request.target ?? ''}"${values.length === 0 ? '' : `, {${values.join(', ')}}`})`;
}

/** Buttons that copy both. */
export function CopyLines(props: { request: RobotRequest; command?: string; python?: string } | { command: string; python: string }) {
  const { word } = useStudio();
  const lines: [string, string, string][] = [
    ['❯_', word('copy'), 'request' in props ? (props.command ?? commandOf(props.request)) : props.command],
    ['py', word('copyPython'), 'request' in props ? (props.python ?? pythonOf(props.request)) : props.python],
  ];
  return (
    <>
      {lines.map(([sign, what, line]) => (
        <CopyButton key={sign} class="copy" label={`${what}: ${line}`} text={line}>
          {sign}
        </CopyButton>
      ))}
    </>
  );
}

/** A button that asks rc10d for something and says what it answered; `copied`: its lines elsewhere, if they differ. */
export function Action(props: { request: RobotRequest; copied?: RobotRequest; label: string; strong?: boolean }) {
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
      <CopyLines request={props.copied ?? props.request} />
      {told !== null && (
        <span class="refused" role="alert" onClick={() => setTold(null)}>
          {told.message}
        </span>
      )}
    </span>
  );
}
