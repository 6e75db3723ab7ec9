import type { ComponentChildren } from 'preact';

import { Action, CopyLines } from './action';
import { useKnown, useStoredOfRobot, useStudio } from './context';
import { duration, number, percent, signedAngle, unitOf, unitOfMode } from './numbers';
import type { Bus, ModuleState, MotorInfo, MotorState } from './protocol';

/** Measured value beside a target of this mode. */
function measuredOf(motor: MotorState): number | null {
  switch (motor.mode) {
    case 'velocity':
      return motor.velocity_rpm;
    case 'angle':
      return signedAngle(motor.angle_deg);
    case 'total_angle':
    case 'impedance':
      return motor.total_angle_deg;
    case 'current':
      return motor.current_a;
    default:
      return null;
  }
}

function Value(props: { name: string; value: number | null; unit: string; digits?: number }) {
  return (
    <div class="value" title={props.name}>
      <span class="value-name">{props.name}</span>
      <span class="value-number">{number(props.value, props.digits ?? 1)}</span>
      <span class="value-unit">{props.value === null ? '' : props.unit}</span>
    </div>
  );
}

/** Source of the torque, in one word: a motor that holds or damps is READY too. */
function actingOf(motor: MotorState, noTorque: string): string {
  if (motor.acting === 'nothing') return motor.status === 'ACTIVE' ? noTorque : '';
  return motor.acting === 'target' ? motor.mode : motor.acting;
}

function MotorCard(props: { info: MotorInfo; motor: MotorState; compact: boolean; favourite: boolean; onFavourite: () => void }) {
  const { word } = useStudio();
  const { info, motor } = props;
  const unit = unitOfMode(motor.mode);
  const target = motor.mode === 'angle' ? signedAngle(motor.target) : motor.target;
  const follows = motor.acting === 'target';
  const torque = motor.acting !== 'nothing';
  const acting = actingOf(motor, word('noTorque'));
  return (
    <article class={`card motor ${motor.status.toLowerCase()} ${torque ? 'torque' : ''}`} aria-label={info.name}>
      <header>
        <button
          type="button"
          class="favourite"
          aria-pressed={props.favourite}
          aria-label={`${word('favourite')} ${info.name}`}
          onClick={props.onFavourite}
        >
          {props.favourite ? '★' : '☆'}
        </button>
        <h3>{info.name}</h3>
        <span class="model">{`${info.model} · ${info.bus} ${info.id}`}</span>
      </header>
      <div class="badges">
        <span class={`badge status ${motor.status.toLowerCase()}`}>{motor.status}</span>
        {acting !== '' && <span class="badge acting">{acting}</span>}
        {motor.limits.map((limit) => (
          <span class="badge limit" key={limit}>{`⚠ ${limit}`}</span>
        ))}
        {!motor.zeroed && motor.status !== 'OFFLINE' && <span class="badge">{word('notReferenced')}</span>}
      </div>
      {motor.fault_text !== '' && <p class="fault">{motor.fault_text}</p>}
      {motor.status !== 'ACTIVE' && motor.stop_cause !== '' && (
        <p class="cause">
          {`${word('stoppedBy')}: ${motor.stop_cause}${motor.stopped_by === '' ? '' : ` (${motor.stopped_by})`}`}
        </p>
      )}
      <div class="values">
        {follows && <Value name={word('target')} value={target} unit={unit} />}
        {follows && unit !== '' && <Value name={word('measured')} value={measuredOf(motor)} unit={unit} />}
        <Value name={word('velocity')} value={motor.velocity_rpm} unit="rpm" />
        {!props.compact && (
          <>
            <Value name={word('angle')} value={motor.zeroed ? motor.total_angle_deg : signedAngle(motor.angle_deg)} unit="°" />
            <Value name={word('current')} value={motor.current_a} unit="A" digits={2} />
            <Value name={word('temperature')} value={motor.temperature_c} unit="°C" digits={0} />
          </>
        )}
      </div>
      <footer>
        {!props.compact && (
          <span class="of-values">
            {`${word('age')} ${duration(motor.feedback_age_us)} `}
            <CopyLines command="rc10ctl watch --once" python={`print(robot.motor("${info.name}"))`} />
          </span>
        )}
        <span>{`${word('owner')} ${motor.owner === '' ? word('nobody') : motor.owner}`}</span>
        <span class="actions">
          {motor.status === 'ACTIVE' || motor.status === 'ENABLING' ? (
            <Action request={{ operation: 'disable', target: info.name }} label={word('disable')} />
          ) : motor.status === 'FAULT' ? (
            <Action request={{ operation: 'clear', target: info.name }} label={word('clear')} />
          ) : (
            <Action request={{ operation: 'enable', target: info.name }} label={word('enable')} />
          )}
        </span>
      </footer>
    </article>
  );
}

function BusCard(props: { bus: Bus }) {
  const { word } = useStudio();
  const { bus } = props;
  return (
    <article class={`card bus ${bus.state === 'active' ? '' : 'bad'}`} aria-label={bus.name}>
      <header>
        <h3>{bus.name}</h3>
        <span class="model">{bus.interface}</span>
      </header>
      <div class="badges">
        <span class={`badge status ${bus.state === 'active' ? 'active' : 'fault'}`}>{bus.state}</span>
      </div>
      <div
        class="meter"
        role="meter"
        aria-label={word('load')}
        aria-valuemin={0}
        aria-valuemax={100}
        aria-valuenow={Math.round(100 * bus.measured_load)}
      >
        <div class="meter-fill" style={{ width: `${Math.min(100, 100 * bus.measured_load)}%` }} />
        <div class="meter-mark" style={{ left: `${Math.min(100, 100 * bus.predicted_load)}%` }} />
      </div>
      <p>
        {`${word('load')} ${percent(bus.measured_load)}, ${word('predicted')} ${percent(bus.predicted_load)}–${percent(bus.predicted_load_worst)}`}
      </p>
      <footer>
        <span>{`${word('errors')} ${bus.error_frames}`}</span>
        <span>{`${word('dropped')} ${bus.tx_dropped + bus.rx_dropped}`}</span>
        <span>{`${word('foreign')} ${bus.rx_foreign}`}</span>
        <CopyLines command="rc10ctl stats" python="print(robot.diagnostics)" />
      </footer>
    </article>
  );
}

function ModuleCard(props: { module: ModuleState }) {
  const { word } = useStudio();
  const { module } = props;
  return (
    <article class="card module" aria-label={module.name}>
      <header>
        <h3>{module.name}</h3>
        <span class="model">{module.type}</span>
      </header>
      <div class="values">
        {Object.entries(module.outputs).map(([name, value]) => (
          <Value key={name} name={name} value={value} unit={unitOf(name)} digits={2} />
        ))}
      </div>
      <footer>
        <span>{`${word('owner')} ${module.owner === '' ? word('nobody') : module.owner}`}</span>
        <CopyLines command="rc10ctl modules" python={`print(robot.module("${module.name}").state)`} />
      </footer>
    </article>
  );
}

/** Cards under a title that folds them away. */
function Section(props: { name: 'motors' | 'modules' | 'buses'; children: ComponentChildren }) {
  const { word } = useStudio();
  const [folded, setFolded] = useStoredOfRobot<string[]>('folded', []);
  const open = !folded.includes(props.name);
  return (
    <section>
      <h2>
        <button
          type="button"
          class="fold"
          aria-expanded={open}
          onClick={() => setFolded(open ? [...folded, props.name] : folded.filter((name) => name !== props.name))}
        >
          {`${open ? '▾' : '▸'} ${word(props.name)}`}
        </button>
      </h2>
      {open && <div class="cards">{props.children}</div>}
    </section>
  );
}

export function Overview() {
  const { word } = useStudio();
  const known = useKnown();
  const [favourites, setFavourites] = useStoredOfRobot<string[]>('favourites', []);
  const [compact, setCompact] = useStoredOfRobot('compact', false);
  const infos = known.robot?.robot.motors ?? [];
  const motors = known.state?.data.motors ?? [];
  const rows = infos
    .map((info, i) => ({ info, motor: motors[i] }))
    .filter((row): row is { info: MotorInfo; motor: MotorState } => row.motor !== undefined);
  const ordered = [
    ...rows.filter((row) => favourites.includes(row.info.name)),
    ...rows.filter((row) => !favourites.includes(row.info.name)),
  ];
  const modules = known.state?.modules.modules ?? [];
  const buses = known.diagnostics?.data.buses ?? [];
  return (
    <>
      <div class="toolbar">
        <Action request={{ operation: 'enable' }} label={word('enableAll')} />
        <Action request={{ operation: 'disable' }} label={word('disableAll')} />
        <Action request={{ operation: 'clear' }} label={word('clear')} />
        <button type="button" aria-pressed={compact} onClick={() => setCompact(!compact)}>
          {word('compact')}
        </button>
        {known.hello?.right === 'look' && <span class="hint">{word('lookOnly')}</span>}
      </div>
      <Section name="motors">
        {ordered.map(({ info, motor }) => (
          <MotorCard
            key={info.name}
            info={info}
            motor={motor}
            compact={compact}
            favourite={favourites.includes(info.name)}
            onFavourite={() =>
              setFavourites(
                favourites.includes(info.name)
                  ? favourites.filter((name) => name !== info.name)
                  : [...favourites, info.name],
              )
            }
          />
        ))}
      </Section>
      {modules.length > 0 && (
        <Section name="modules">
          {modules.map((module) => (
            <ModuleCard key={module.name} module={module} />
          ))}
        </Section>
      )}
      <Section name="buses">
        {buses.map((bus) => (
          <BusCard key={bus.name} bus={bus} />
        ))}
      </Section>
    </>
  );
}
