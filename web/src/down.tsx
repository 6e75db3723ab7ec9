// The notice while rc10d is not running: the reason, why it refused to start, the end of its last log.
import { useStudio } from './context';
import type { Down } from './protocol';

function Part(props: { title: string; at: number; text: string; open: boolean }) {
  if (props.text === '') return null;
  const when = new Date(props.at * 1000).toLocaleString(undefined, { hour12: false });
  return (
    <details open={props.open}>
      <summary>{`${props.title} (${when})`}</summary>
      <pre tabIndex={0} aria-label={props.title}>
        {props.text}
      </pre>
    </details>
  );
}

export function DownNotice(props: { down: Down }) {
  const { word } = useStudio();
  const { down } = props;
  const refused = down.refusal !== '';
  return (
    <section class="down" aria-label={word('down')}>
      <div role="alert">
        <strong>{word('down')}</strong>
        <p>{down.reason}</p>
      </div>
      <Part title={word('downRefusal')} at={down.refused_at} text={down.refusal} open />
      <Part title={word('downLog')} at={down.logged_at} text={down.log} open={!refused} />
    </section>
  );
}
