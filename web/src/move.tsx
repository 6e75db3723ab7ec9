// One motor by hand: a held button moves it, its curves and its gains beside it.
import { useEffect, useRef, useState } from 'preact/hooks';

import { CapturePanel } from './capture';
import { useChosenMotor } from './chosen_motor';
import { useKnown, useStored, useStudio } from './context';
import { Gains } from './gains';
import { useHold } from './hold';
import { unitOf } from './numbers';
import { NumberField } from './number_field';
import { Curves } from './plots';

// rc10-web gives each renewal a lease of 150 ms.
const kRenewMs = 50;
const kLeaseMs = 150;
// By then a state from after the first of them has come: a second.
const kTakenRenewals = 20;
// A command of a client was refused.
const kCommandRefused = 202;
const kModes = ['velocity', 'current'] as const;
type HeldMode = (typeof kModes)[number];
const kUnits: Record<HeldMode, string> = { velocity: 'rpm', current: 'A' };
const kFirst: Record<HeldMode, number> = { velocity: 20, current: 0.5 };

function Jog(props: { motor: string; modes: HeldMode[]; mode: HeldMode; onMode: (mode: HeldMode) => void }) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [sizes, setSizes] = useStored<Record<HeldMode, number>>('jogSizes', kFirst);
  const [direction, setDirection] = useState(0);
  const [told, setTold] = useState('');
  const renewed = useRef(0);
  const timer = useRef(0);
  const release = useRef<() => void>(() => {});
  const chosen = props.mode;
  const motor = known.state?.data.motors.find((each) => each.name === props.motor);
  const ready = motor?.status === 'ACTIVE' && known.hello?.right === 'command';
  const owner = motor?.owner ?? '';
  const ownerNow = useRef(owner);
  ownerNow.current = owner;
  const name = known.hello?.name ?? '';
  const other = owner !== '' && owner !== name ? owner : '';

  // rc10d answers no command: its events say what became of it.
  const whyNotTaken = () => {
    const refusal = link.known.events.find((event) => event.code === kCommandRefused && event.text.includes(name));
    return refusal === undefined ? word('jogNotTaken') : `${word('jogNotTaken')} ${refusal.text}`;
  };

  const stop = (why: string) => {
    clearInterval(timer.current);
    release.current();
    setDirection(0);
    setTold(why);
  };
  // A second finger or key ends it: whoever holds on to one thing means one thing.
  const ends = { released: '', other: word('jogSecond'), left: word('jogAway') };
  const hold = useHold(props.motor, (why) => stop(ends[why]));
  const letGo = (why: string) => {
    if (!hold.held()) return;
    hold.clear();
    stop(why);
  };

  const begin = (sign: number) => {
    if (!ready || other !== '') {
      setTold(ready ? `${word('jogOther')} ${other}` : word('jogNotActive'));
      return false;
    }
    setDirection(sign);
    setTold('');
    const target = { motor: props.motor, mode: chosen, value: sign * Math.abs(sizes[chosen]) };
    const held = link.hold(target, (why) => letGo(why));
    release.current = held.release;
    renewed.current = performance.now();
    let renewals = 0;
    timer.current = window.setInterval(() => {
      // A page that stood still has let go: nothing starts again by itself.
      const late = performance.now() - renewed.current > kLeaseMs;
      renewed.current = performance.now();
      if (late) letGo(word('jogStill'));
      else if (!held.renew()) letGo(word('jogLost'));
      else if (++renewals > kTakenRenewals && ownerNow.current !== name) letGo(whyNotTaken());
    }, kRenewMs);
    return true;
  };

  useEffect(() => {
    const left = () => hold.end('left');
    const hidden = () => document.hidden && left();
    const focusGone = () => hold.byKey() && left();
    const options = { capture: true };
    window.addEventListener('pagehide', left);
    document.addEventListener('visibilitychange', hidden);
    window.addEventListener('focusin', focusGone, options);
    return () => {
      window.removeEventListener('pagehide', left);
      document.removeEventListener('visibilitychange', hidden);
      window.removeEventListener('focusin', focusGone, options);
    };
  }, [props.motor]);
  useEffect(() => {
    if (!ready) letGo(word('jogNotActive'));
  }, [ready]);
  useEffect(() => {
    if (other !== '') letGo(`${word('jogOther')} ${other}`);
  }, [other]);

  const button = (sign: number, label: string, key: string) => (
    <button
      type="button"
      class={`jog ${direction === sign ? 'held' : ''}`}
      disabled={!ready}
      aria-label={label}
      title={`${label} (${key})`}
      {...hold.pointerHandlers(() => begin(sign))}
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
          hold.beginByKey(event, () => begin(sign));
        }}
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
  const { info, bar } = useChosenMotor();
  const [angle, setAngle] = useStored('moveAngle', false);
  const [storedMode, setMode] = useStored<HeldMode>('jogMode', 'velocity');
  if (info === undefined) return null;
  const modes = kModes.filter((each) => info.modes.includes(each));
  const mode = modes.includes(storedMode) ? storedMode : (modes[0] ?? 'velocity');
  // A target stands on the axis of what it moves: what jog asks for, or an angle of a program.
  const unit = (signal: string) => (signal.endsWith('.target_shaped') ? (angle ? '°' : kUnits[mode]) : unitOf(signal));
  const readings = ['target_shaped', 'velocity_rpm', 'current_a', ...(angle ? ['total_angle_deg'] : [])];
  const signals = readings.map((reading) => `${info.name}.${reading}`);
  return (
    <>
      {bar}
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
          <label class="hint">
            <input type="checkbox" checked={angle} onChange={() => setAngle(!angle)} />
            {word('moveAngle')}
          </label>
          <Curves signals={signals} unit={unit} />
          <CapturePanel motor={info.name} unit={unit} />
        </div>
      </div>
    </>
  );
}
