import { useKnown, useStored, useStudio } from './context';
import { Remedy } from './remedy';

export function Events() {
  const { word } = useStudio();
  const known = useKnown();
  const [problems, setProblems] = useStored('events.problems', false);
  const events = known.events.filter((event) => !problems || event.severity !== 'info');
  return (
    <>
      <div class="toolbar">
        <button type="button" aria-pressed={!problems} onClick={() => setProblems(false)}>
          {word('all')}
        </button>
        <button type="button" aria-pressed={problems} onClick={() => setProblems(true)}>
          {word('problems')}
        </button>
      </div>
      {events.length === 0 && <p class="hint">{word('noEvents')}</p>}
      <table class="events">
        <tbody>
          {events.map((event, i) => (
            <tr key={`${event.mono_us}-${event.code}-${event.source}-${events.length - i}`} class={event.severity}>
              <td class="time">{new Date(event.utime / 1000).toLocaleTimeString(undefined, { hour12: false })}</td>
              <td>
                <span class={`badge ${event.severity}`}>{event.severity}</span>
              </td>
              <td class="source">{event.source}</td>
              <td>
                {event.text} <Remedy event={event} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </>
  );
}
