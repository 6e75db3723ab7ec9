// One motor by hand: a held button moves it, its curves and its gains beside it.
import { useEffect, useRef, useState } from 'preact/hooks';

import { Action } from './action';
import { CapturePanel } from './capture';
import { useKnown, useStored, useStudio } from './context';
import { Gains } from './gains';
import { unitOf } from './numbers';
import { NumberField } from './number_field';
import { Curves } from './plots';

// rc10-web gives each renewal a lease of 150 ms.
const kRenewMs = 50;
const kModes = ['velocity', 'current'] as const;
type HeldMode = (typeof kModes)[number];
const kUnits: Record<HeldMode, string> = { velocity: 'rpm', current: 'A' };
const kFirst: Record<HeldMode, number> = { velocity: 20, current: 0.5 };

/** What holds it now: a pointer by its number, or a key. */
type Holder = number | 'key' | null;

function Jog(props: { motor: string; modes: HeldMode[]; mode: HeldMode; onMode: (mode: HeldMode) => void }) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [sizes, setSizes] = useStored<Record<HeldMode, number>>('jogSizes', kFirst);
  const [direction, setDirection] = useState(0);
  const [told, setTold] = useState('');
  const holder = useRef<Holder>(null);
  const timer = useRef(0);
  const release = useRef<() => void>(() => {});
  const chosen = props.mode;
  const motor = known.state?.data.motors.find((each) => each.name === props.motor);
  const ready = motor?.status === 'ACTIVE' && known.hello?.right === 'command';
  const owner = motor?.owner ?? '';
  const other = owner !== '' && owner !== known.hello?.name ? owner : '';

  const letGo = (why: string) => {
    if (holder.current === null) return;
    holder.current = null;
    clearInterval(timer.current);
    release.current();
    setDirection(0);
    setTold(why);
  };

  const hold = (by: Holder, sign: number) => {
    // A second finger or key ends it: whoever holds on to one thing means one thing.
    if (holder.current !== null) return letGo(word('jogSecond'));
    if (!ready) return setTold(word('jogNotActive'));
    if (other !== '') return setTold(`${word('jogOther')} ${other}`);
    holder.current = by;
    setDirection(sign);
    setTold('');
    const target = { motor: props.motor, mode: chosen, value: sign * Math.abs(sizes[chosen]) };
    const held = link.hold(target, (why) => letGo(why));
    release.current = held.release;
    timer.current = window.setInterval(() => {
      if (!held.renew()) letGo(word('jogLost'));
    }, kRenewMs);
  };

  useEffect(() => {
    const away = () => letGo(word('jogAway'));
    const hidden = () => document.hidden && away();
    window.addEventListener('blur', away);
    window.addEventListener('pagehide', away);
    document.addEventListener('visibilitychange', hidden);
    return () => {
      away();
      window.removeEventListener('blur', away);
      window.removeEventListener('pagehide', away);
      document.removeEventListener('visibilitychange', hidden);
    };
  }, [props.motor]);
  useEffect(() => {
    if (!ready) letGo(word('jogNotActive'));
  }, [ready]);
  useEffect(() => {
    if (other !== '') letGo(`${word('jogOther')} ${other}`);
  }, [other]);
  // Another finger, anywhere on the page.
  useEffect(() => {
    const finger = (event: PointerEvent) => {
      if (typeof holder.current === 'number' && event.pointerId !== holder.current) letGo(word('jogSecond'));
    };
    window.addEventListener('pointerdown', finger, { capture: true });
    return () => window.removeEventListener('pointerdown', finger, { capture: true });
  }, [props.motor]);

  const button = (sign: number, label: string, key: string) => (
    <button
      type="button"
      class={`jog ${direction === sign ? 'held' : ''}`}
      disabled={!ready}
      aria-label={label}
      title={`${label} (${key})`}
      onPointerDown={(event) => {
        event.currentTarget.setPointerCapture(event.pointerId);
        hold(event.pointerId, sign);
      }}
      onPointerUp={() => letGo('')}
      onPointerCancel={() => letGo(word('jogAway'))}
      onLostPointerCapture={() => letGo('')}
      onContextMenu={(event) => event.preventDefault()}
    >
      {sign > 0 ? '↺' : '↻'}
    </button>
  );
  const keys: Record<string, number> = { ArrowRight: 1, ArrowLeft: -1 };

  return (
    <section class="card jogs" aria-label={word('jog')}>
      <h3>{word('jog')}</h3>
      <div class="toolbar">
        <label>
          {`${word('mode')} `}
          <select
            value={chosen}
            onChange={(event) => props.onMode(event.currentTarget.value as HeldMode)}
            disabled={direction !== 0}
          >
            {props.modes.map((each) => (
              <option key={each}>{each}</option>
            ))}
          </select>
        </label>
        <label>
          <NumberField
            key={chosen}
            label={kUnits[chosen]}
            least={0}
            value={sizes[chosen]}
            disabled={direction !== 0}
            onValue={(size) => setSizes({ ...sizes, [chosen]: Math.abs(size) })}
          />
          {` ${kUnits[chosen]}`}
        </label>
      </div>
      <div
        class="jog-buttons"
        role="group"
        aria-label={word('jogKeys')}
        tabIndex={0}
        onKeyDown={(event) => {
          const sign = keys[event.key];
          if (sign === undefined) return;
          event.preventDefault();
          if (!event.repeat) hold('key', sign);
        }}
        onKeyUp={(event) => keys[event.key] !== undefined && letGo('')}
        onBlur={() => holder.current === 'key' && letGo(word('jogAway'))}
      >
        {button(-1, word('jogNegative'), '←')}
        {button(1, word('jogPositive'), '→')}
        <span class="hint">{word('jogKeys')}</span>
      </div>
      <p class={told === '' ? 'hint' : 'refused'} role="status">
        {direction !== 0 ? word('jogHeld') : told === '' ? word('jogHint') : told}
      </p>
    </section>
  );
}

export function Move() {
  const { word } = useStudio();
  const known = useKnown();
  const [stored, setMotor] = useStored('moveMotor', '');
  const [storedMode, setMode] = useStored<HeldMode>('jogMode', 'velocity');
  const infos = known.robot?.robot.motors ?? [];
  const info = infos.find((each) => each.name === stored) ?? infos[0];
  const motor = known.state?.data.motors.find((each) => each.name === info?.name);
  if (info === undefined) return null;
  const modes = kModes.filter((each) => info.modes.includes(each));
  const mode = modes.includes(storedMode) ? storedMode : (modes[0] ?? 'velocity');
  // What jog asks for stands on the axis of what it moves.
  const unit = (signal: string) => (signal.endsWith('.target_shaped') ? kUnits[mode] : unitOf(signal));
  const signals = ['target_shaped', 'velocity_rpm', 'current_a'].map((reading) => `${info.name}.${reading}`);
  return (
    <>
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
              <Action request={{ operation: 'enable', target: info.name }} label={word('enable')} />
            )}
            {motor.fault_text !== '' && <span class="refused">{motor.fault_text}</span>}
          </>
        )}
      </div>
      <div class="move">
        <div class="side">
          {modes.length > 0 ? (
            <Jog key={info.name} motor={info.name} modes={modes} mode={mode} onMode={setMode} />
          ) : (
            <p class="hint">{word('jogNone')}</p>
          )}
          <Gains key={`gains ${info.name}`} motor={info.name} />
        </div>
        <div class="curves">
          <Curves signals={signals} unit={unit} />
          <CapturePanel motor={info.name} unit={unit} />
        </div>
      </div>
    </>
  );
}
