// The robot that a text describes: its buses with ids and load, what each motor does at its ends, its groups.
import { useStudio } from './context';
import { number } from './numbers';
import type { CheckedBus, CheckedConfig, CheckedGroup } from './protocol';

type Robot = NonNullable<CheckedConfig['checked']['robot']>;

function percent(share: number): string {
  return `${number(100 * share, 1)} %`;
}

function BusTable(props: { bus: CheckedBus }) {
  const { word } = useStudio();
  const { bus } = props;
  const rates = bus.data_bitrate > 0 ? `${bus.bitrate} / ${bus.data_bitrate} bit/s` : `${bus.bitrate} bit/s`;
  return (
    <section class="card bus-plan" aria-label={bus.name}>
      <h3>{bus.name}</h3>
      <p>
        {`${bus.interface === '' ? word('simulated') : bus.interface} · ${rates} · ${word('load')} `}
        <strong>{`${percent(bus.load)} – ${percent(bus.load_worst)}`}</strong>
        <span class="hint">{` (${word('configWorst')})`}</span>
      </p>
      <div class="meter" aria-hidden="true">
        <div class="meter-fill" style={{ width: `${Math.min(100, 100 * bus.load)}%` }} />
        <div class="meter-mark" style={{ left: `${Math.min(100, 100 * bus.load_worst)}%` }} />
      </div>
      <div class="scroll" tabIndex={0} role="group" aria-label={bus.name}>
        <table class="timing">
          <thead>
            <tr>
              <th scope="col">{word('motor')}</th>
              <th scope="col">model</th>
              <th scope="col" class="number">
                id
              </th>
              <th scope="col">{word('configCommand')}</th>
              <th scope="col">{word('configFeedback')}</th>
              <th scope="col" class="number">
                {word('configMotorLoad')}
              </th>
              <th scope="col">{word('configTimeout')}</th>
              <th scope="col">{word('configDisable')}</th>
              <th scope="col">{word('configEstop')}</th>
            </tr>
          </thead>
          <tbody>
            {bus.motors.map((motor) => (
              <tr key={motor.name}>
                <th scope="row">{motor.name}</th>
                <td>{motor.model}</td>
                <td class="number">{motor.id}</td>
                <td>{motor.command}</td>
                <td>{motor.feedback}</td>
                <td class="number">{percent(motor.load)}</td>
                <td>{motor.on_timeout}</td>
                <td>{motor.on_disable}</td>
                <td>{motor.on_estop}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </section>
  );
}

function Group(props: { group: CheckedGroup }) {
  const { word } = useStudio();
  const { group } = props;
  const ends = [word(group.together ? 'configTogether' : 'configStopTogether'), word(group.rearms_at_rest ? 'configAtRest' : 'configByRequest')];
  return (
    <li>
      <strong>{group.name}</strong>
      {`: ${group.motors.join(', ')} · ${ends.join(' · ')}`}
    </li>
  );
}

export function CheckedTables(props: { robot: Robot; old: boolean }) {
  const { word } = useStudio();
  const { robot, old } = props;
  return (
    <div class={`config-tables ${old ? 'old' : ''}`}>
      <h2>{`${word('buses')}: ${robot.name}`}</h2>
      {old && <p class="notice">{word('configBefore')}</p>}
      {robot.buses.map((bus) => (
        <BusTable key={bus.name} bus={bus} />
      ))}
      {robot.groups.length > 0 && (
        <section aria-label={word('configGroups')}>
          <h2>{word('configGroups')}</h2>
          <ul>
            {robot.groups.map((group) => (
              <Group key={group.name} group={group} />
            ))}
          </ul>
        </section>
      )}
      <details class="notes">
        <summary>{word('configReport')}</summary>
        <pre tabIndex={0} aria-label={word('configReport')}>
          {robot.report}
        </pre>
      </details>
    </div>
  );
}
