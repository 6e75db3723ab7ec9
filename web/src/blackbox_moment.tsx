// All that a recording says of one moment: states, and what came just before and after.
import type { ComponentChildren } from 'preact';

import { useStudio } from './context';
import { duration, number } from './numbers';
import { type RecordedWordBook, useWords } from './recorded_words';
import { kSame_us } from './recording';
import type { EventRow, FrameRow, Moment, MotorRow } from './recording_look';

function Table(props: { title: string; heads: string[]; tools?: ComponentChildren; children: ComponentChildren }) {
  return (
    <section aria-label={props.title}>
      <h2>{props.title}</h2>
      {props.tools !== undefined && <div class="toolbar">{props.tools}</div>}
      <div class="scroll" tabIndex={0} role="group" aria-label={props.title}>
        <table class="timing moment">
          <thead>
            <tr>
              {props.heads.map((head, i) => (
                <th key={i} scope="col">
                  {head}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>{props.children}</tbody>
        </table>
      </div>
    </section>
  );
}

const kReadings: [string, string, number][] = [
  ['velocity_rpm', 'rpm', 1],
  ['current_a', 'A', 2],
  ['torque_nm', 'N·m', 2],
  ['total_angle_deg', '°', 1],
  ['angle_deg', '°', 1],
  ['voltage_v', 'V', 1],
  ['temperature_c', '°C', 0],
];

function Motor(props: { motor: MotorRow }) {
  const { motor } = props;
  const of = (name: string) => motor.numbers[name];
  const age = (name: string) => (of(name) === undefined ? '–' : duration(of(name) ?? -1));
  const acting = motor.acting === 'target' ? motor.mode : motor.acting;
  return (
    <tr>
      <th scope="row">{motor.name}</th>
      <td>
        <span class={`badge status ${motor.status.toLowerCase()}`}>{motor.status === '' ? '–' : motor.status}</span>
      </td>
      <td>{acting === 'nothing' ? '' : acting}</td>
      <td class="number">{`${number(of('target'), 2)} ${motor.unit}`}</td>
      <td class="number">{`${number(of('target_shaped'), 2)} ${motor.unit}`}</td>
      {kReadings.map(([name, unit, digits]) => (
        <td key={name} class={`number ${name}`}>{`${number(of(name), digits)} ${unit}`}</td>
      ))}
      <td class="number">{`${number(of('command_value'), 2)} ${motor.command_unit}`}</td>
      <td class="number">{age('feedback_age_us')}</td>
      <td class="number">{age('command_age_us')}</td>
      <td>{[...motor.limits, motor.fault_text, motor.stop_cause].filter((word) => word !== '').join(', ')}</td>
    </tr>
  );
}

function When(props: { time_us: number; onAt: (at_us: number) => void }) {
  return (
    <td class="number">
      <button type="button" class="when" onClick={() => props.onAt(props.time_us)}>
        {`${number(props.time_us / 1e6, 4)} s`}
      </button>
    </td>
  );
}

interface Shown {
  moment: Moment;
  book: RecordedWordBook;
  filter: string;
  onFilter: (filter: string) => void;
  problems: boolean;
  onProblems: (problems: boolean) => void;
  onAt: (at_us: number) => void;
}

export function MomentTables(props: Shown) {
  const { word } = useStudio();
  const { moment, book, onAt } = props;
  const { at_us } = moment;
  useWords(book, moment.events, moment.frames);
  const { robot } = moment;
  const place = (row: EventRow | FrameRow) => (Math.abs(row.time_us - at_us) <= kSame_us ? 'here' : row.time_us < at_us ? 'past' : 'coming');
  const way = (frame: FrameRow) => (frame.refused ? 'boxRefused' : frame.sent ? 'boxSent' : 'boxReceived');
  return (
    <>
      <div class="toolbar">
        <span class={`badge robot ${robot?.state.toLowerCase() ?? ''}`}>{robot?.state ?? '–'}</span>
        {robot !== null && robot.stop_cause !== '' && <span class="cause">{robot.stop_cause}</span>}
        {robot?.conditions.map((condition) => (
          <span key={condition} class="badge">
            {condition}
          </span>
        ))}
        {robot !== null && <span class="hint">{`${word('missed')} ${robot.numbers['missed_ticks'] ?? 0}`}</span>}
      </div>
      <Table
        title={word('motors')}
        heads={['', '', '', word('target'), word('boxShaped'), ...kReadings.map(([name]) => name.replace(/_[a-z]+$/, '')), word('boxCommanded'), word('age'), word('boxCommandAge'), '']}
      >
        {moment.motors.map((motor) => (
          <Motor key={motor.name} motor={motor} />
        ))}
      </Table>
      {moment.modules.length > 0 && (
        <Table title={word('modules')} heads={['', word('owner'), '', '']}>
          {moment.modules.map((module) => (
            <tr key={module.name}>
              <th scope="row">{module.name}</th>
              <td>{module.client}</td>
              <td>{module.verdict}</td>
              <td>
                {Object.entries(module.inputs)
                  .map(([name, value]) => `${name} ${number(value, 3)}`)
                  .join(' · ')}
              </td>
            </tr>
          ))}
        </Table>
      )}
      <Table title={word('buses')} heads={['', '', 'rx', 'tx', word('dropped'), word('errors'), 'tec', 'rec']}>
        {moment.buses.map((bus) => (
          <tr key={bus.name}>
            <th scope="row">{bus.name}</th>
            <td>{bus.state}</td>
            {['rx_frames', 'tx_frames', 'tx_dropped', 'error_frames', 'tec', 'rec'].map((name) => (
              <td key={name} class="number">
                {number(bus.numbers[name] === -1 ? null : bus.numbers[name], 0)}
              </td>
            ))}
          </tr>
        ))}
      </Table>
      <Table
        title={word('events')}
        heads={['', '', '', '']}
        tools={
          <>
            <button type="button" aria-pressed={!props.problems} onClick={() => props.onProblems(false)}>
              {word('all')}
            </button>
            <button type="button" aria-pressed={props.problems} onClick={() => props.onProblems(true)}>
              {word('problems')}
            </button>
          </>
        }
      >
        {moment.events.map((event, i) => (
          <tr key={i} class={`${event.severity} ${place(event)}`}>
            <When time_us={event.time_us} onAt={onAt} />
            <td>
              <span class={`badge ${event.severity}`}>{event.severity}</span>
            </td>
            <td>{event.source}</td>
            <td class="told">{book.event(event)}</td>
          </tr>
        ))}
      </Table>
      <Table title={word('boxOrders')} heads={['', word('owner'), '', '']}>
        {moment.orders.map((order, i) => (
          <tr key={i} class={order.time_us > at_us + kSame_us ? 'coming' : 'past'}>
            <When time_us={order.time_us} onAt={onAt} />
            <td>{order.who}</td>
            <td class="told">{order.what}</td>
            <td>{order.verdict}</td>
          </tr>
        ))}
      </Table>
      <Table
        title={word('boxFrames')}
        heads={['', '', '', '', '']}
        tools={
          <label>
            {`${word('boxFilter')} `}
            <input type="search" value={props.filter} maxLength={40} placeholder="201" onInput={(event) => props.onFilter(event.currentTarget.value)} />
          </label>
        }
      >
        {moment.frames.map((frame, i) => (
          <tr key={i} class={place(frame)}>
            <When time_us={frame.time_us} onAt={onAt} />
            <td>{frame.bus_name}</td>
            <td>{word(way(frame))}</td>
            <td class="bytes">{frame.text}</td>
            <td class="told">{book.frame(frame)}</td>
          </tr>
        ))}
      </Table>
    </>
  );
}
