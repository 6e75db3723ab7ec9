// Choice of a motor for the parts that move one.
import type { ComponentChildren } from 'preact';

import { Action } from './action';
import { useKnown, useStored, useStudio } from './context';
import { type MotorInfo, kDisableAtEnd } from './protocol';

/** Choice of a motor, which the parts that move one share, with its state. */
export function useChosenMotor(): { info: MotorInfo | undefined; bar: ComponentChildren } {
  const { word } = useStudio();
  const known = useKnown();
  const [stored, setMotor] = useStored('moveMotor', '');
  const infos = known.robot?.robot.motors ?? [];
  const info = infos.find((each) => each.name === stored) ?? infos[0];
  const motor = known.state?.data.motors.find((each) => each.name === info?.name);
  if (info === undefined) return { info, bar: null };
  const bar = (
    <div class="toolbar">
      <label>
        {`${word('motor')} `}
        <select value={info.name} onChange={(event) => setMotor(event.currentTarget.value)}>
          {infos.map((each) => (
            <option key={each.name}>{each.name}</option>
          ))}
        </select>
      </label>
      {motor !== undefined && (
        <>
          <span class={`badge status ${motor.status.toLowerCase()}`}>{motor.status}</span>
          <span class="hint">{`${word('owner')} ${motor.owner === '' ? word('nobody') : motor.owner}`}</span>
          {motor.status === 'ACTIVE' || motor.status === 'ENABLING' ? (
            <Action request={{ operation: 'disable', target: info.name }} label={word('disable')} />
          ) : motor.status === 'FAULT' ? (
            <Action request={{ operation: 'clear', target: info.name }} label={word('clear')} />
          ) : (
            <Action request={{ operation: 'enable', target: info.name, values: kDisableAtEnd }} copied={{ operation: 'enable', target: info.name }} label={word('enable')} />
          )}
          {motor.fault_text !== '' && <span class="refused">{motor.fault_text}</span>}
        </>
      )}
    </div>
  );
  return { info, bar };
}
