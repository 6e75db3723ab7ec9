// Stiffness and damping that a measurement proposes, for drives whose angle targets are a spring: keys of the robot's file.
import { useEffect, useRef, useState } from 'preact/hooks';

import { CopyButton } from './clipboard';
import { putIntoDraft } from './config_draft';
import { loadSchema } from './config_schema';
import { useStudio } from './context';
import { type Run, MeasurementForm, useMeasurement } from './measurement';
import { type TestPlan, springOf, testPython } from './motion_test';
import { number } from './numbers';
import type { MotorInfo } from './protocol';
import { Refusal } from './refusal';
import { withMotorKeys } from './yaml_motor';

// These drives report one of both, and the other follows from it: any current but none tells the ratio.
const kLeastCurrentA = 0.02;

/** Torque by each ampere, from the motor's own readings while a current flows; null: none was seen yet. */
function useTorquePerAmpere(motor: string): { current: number | null } {
  const { link } = useStudio();
  const found = useRef<number | null>(null);
  useEffect(
    () =>
      link.subscribe(() => {
        const now = link.known.state?.data.motors.find((each) => each.name === motor);
        const { torque_nm: torque, current_a: current } = now ?? { torque_nm: null, current_a: null };
        if (torque !== null && current !== null && Math.abs(current) >= kLeastCurrentA) found.current = torque / current;
      }),
    [link, motor],
  );
  return found;
}

/** Whether the file has keys for the spring of this model; the schema tells. */
function useHasKeys(model: string): boolean {
  const [has, setHas] = useState(false);
  useEffect(() => {
    let gone = false;
    void loadSchema().then((schema) => {
      if (!gone) setHas(schema?.keysOf(model).includes('angle_stiffness_nm_per_rad') === true);
    });
    return () => {
      gone = true;
    };
  }, [model]);
  return has;
}

export function SpringProposal(props: { info: MotorInfo; plan: TestPlan; busy: boolean; run: Run }) {
  const { link, word } = useStudio();
  const motor = props.info.name;
  const of = useMeasurement(motor, props.plan, props.run);
  const torquePerAmpere = useTorquePerAmpere(motor);
  const [told, setTold] = useState('');
  const [proposed, setProposed] = useState<Record<string, number> | null>(null);
  const [refused, setRefused] = useState('');
  const hasKeys = useHasKeys(props.info.model);
  if (!hasKeys) return null;

  const measure = async () => {
    setTold('');
    setRefused('');
    setProposed(null);
    const acceleration = await of.measure();
    if (acceleration === null) return;
    if (torquePerAmpere.current === null) return setTold(word('springNoTorque'));
    const spring = springOf(acceleration, torquePerAmpere.current, of.pulses.time_constant_s);
    setProposed(spring);
    setTold(spring === null ? word('proposalNone') : `${number(acceleration, 0)} rpm/s/A, ${number(torquePerAmpere.current, 3)} N·m/A`);
  };
  const put = async (keys: Record<string, number>) => {
    const file = await link.config();
    if (typeof file === 'string' || file.config.why !== '') return setRefused(typeof file === 'string' ? file : file.config.why);
    const change = (text: string) => withMotorKeys(text, motor, keys);
    if (!putIntoDraft(file.config.text, change, `${word('proposal')}: ${motor}`)) setRefused(word('comNotPut'));
  };
  const lines = Object.entries(proposed ?? {}).map(([key, value]) => `${key}: ${value}`).join('\n');
  return (
    <section class="card test" aria-label={word('proposal')}>
      <h3>{word('proposal')}</h3>
      <p class="hint">{word('springHint')}</p>
      <MeasurementForm motor={motor} of={of} busy={props.busy} python={testPython(motor, of.pulse(1))} onMeasure={() => void measure()} />
      {told !== '' && <p role="status">{told}</p>}
      {proposed !== null && (
        <>
          <pre tabIndex={0} aria-label={word('gainsLines')}>
            {lines}
          </pre>
          <div class="toolbar">
            <CopyButton text={lines}>{word('gainsCopy')}</CopyButton>
            <button type="button" class="strong" onClick={() => void put(proposed)}>
              {word('comPut')}
            </button>
            <Refusal why={refused} />
          </div>
        </>
      )}
    </section>
  );
}
