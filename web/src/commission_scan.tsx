// Drives of a bus, as rc10d hears them on request, and lines for one that the file does not have.
import { useState } from 'preact/hooks';

import { CopyLines, requestPython } from './action';
import { CopyButton } from './clipboard';
import { type HeardDrive, drivesOf, isOfKind, modelsOf, motorLine } from './commission_drives';
import { putIntoDraft } from './config_draft';
import { useKnown, useStudio } from './context';
import { NumberField } from './number_field';
import type { Response } from './protocol';
import { Refusal } from './refusal';
import { filled } from './words_commission';
import { withMotorKeys, withNewMotor } from './yaml_motor';

interface Chosen {
  name: string;
  model: string;
  id: number;
  /** Other keys that the drive's frames tell. */
  own: Record<string, number>;
}

/** Name, model and id of a drive on their way into the file. */
function NewMotor(props: { bus: string; names: string[]; chosen: Chosen; text: string | null; onSet: (chosen: Chosen) => void }) {
  const { word } = useStudio();
  const [told, setTold] = useState('');
  const { chosen, text } = props;
  const known = props.names.includes(chosen.name);
  const keys = { id: chosen.id, ...chosen.own };
  const line = known
    ? Object.entries(keys)
        .map(([key, value]) => `${key}: ${value}`)
        .join('\n')
    : motorLine(chosen.name, chosen.model, keys);
  const put = () => {
    const change = (old: string) => (known ? withMotorKeys(old, chosen.name, keys) : withNewMotor(old, props.bus, line));
    if (text === null || !putIntoDraft(text, change, `${word('commission')}: ${chosen.name}`)) setTold(word('comNotPut'));
  };
  return (
    <>
      <div class="toolbar">
        <label>
          {`${word('comScanName')} `}
          <input
            type="text"
            value={chosen.name}
            maxLength={31}
            onInput={(event) => props.onSet({ ...chosen, name: event.currentTarget.value })}
          />
        </label>
        {!known && (
          <label>
            {'model '}
            <input
              type="text"
              list="scan-models"
              value={chosen.model}
              placeholder={word('comScanLabel')}
              onInput={(event) => props.onSet({ ...chosen, model: event.currentTarget.value })}
            />
          </label>
        )}
        <label>
          {'id '}
          <NumberField label="id" value={chosen.id} least={0} onValue={(id) => props.onSet({ ...chosen, id })} />
        </label>
      </div>
      <pre aria-label={word('comScanLines')}>{line}</pre>
      <p class="hint">{filled(word(known ? 'comScanKnown' : 'comScanNew'), { motor: chosen.name, bus: props.bus })}</p>
      <div class="toolbar">
        <CopyButton text={line}>{word('gainsCopy')}</CopyButton>
        <button type="button" disabled={text === null || chosen.name === '' || (!known && chosen.model === '')} onClick={put}>
          {word('comPut')}
        </button>
        <Refusal why={told} />
      </div>
    </>
  );
}

function Drives(props: { drives: HeardDrive[]; onUse: (drive: HeardDrive) => void }) {
  const { word } = useStudio();
  return (
    <div class="scroll" tabIndex={0} role="group" aria-label={word('comScanHeard')}>
      <table class="timing">
        <thead>
          <tr>
            <th scope="col">{word('comScanDrive')}</th>
            <th scope="col" class="number">
              id
            </th>
            <th scope="col">{word('motor')}</th>
            <th scope="col" class="number">
              {word('comScanFrames')}
            </th>
            <th scope="col">{word('comScanIds')}</th>
            <th scope="col">{word('comScanUse')}</th>
          </tr>
        </thead>
        <tbody>
          {props.drives.map((drive) => (
            <tr key={`${drive.kind} ${drive.id} ${drive.ids[0]}`}>
              <th scope="row">{`${drive.kind}${drive.ambiguous ? ' ?' : ''}`}</th>
              <td class="number">{drive.id}</td>
              <td class={drive.collides ? 'bad' : ''}>
                {drive.motor === null ? word('comScanStranger') : drive.collides ? filled(word('comScanCollides'), { motor: drive.motor }) : drive.motor}
              </td>
              <td class="number">{drive.frames}</td>
              <td>{drive.ids.join(', ')}</td>
              <td>
                {drive.motor === null && (
                  <button type="button" aria-label={`${word('comScanUse')}: ${drive.kind} ${drive.id}`} onClick={() => props.onUse(drive)}>
                    {word('comScanUse')}
                  </button>
                )}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

export function BusScan(props: { bus: string; motor: string; text: string | null }) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [answer, setAnswer] = useState<Response | null>(null);
  const [busy, setBusy] = useState(false);
  const [chosen, setChosen] = useState<Chosen | null>(null);
  const motors = known.robot?.robot.motors ?? [];
  const states = known.state?.data.motors ?? [];
  const request = { operation: 'scan', target: props.bus };
  const scan = async () => {
    setBusy(true);
    setChosen(null);
    setAnswer(null);
    setAnswer(await link.scan(request));
    setBusy(false);
  };
  const ok = answer?.status === 'ok';
  const drives = ok ? drivesOf(answer.heard) : [];
  const [, ...advice] = ok ? answer.message.split('\n') : [''];
  const unknown = ok ? answer.heard.filter((each) => each.advice !== null) : [];
  const use = (drive: HeardDrive) => {
    // A motor that nobody hears may be this drive, with another id than the file says.
    const silent = states.find((each) => each.name === props.motor)?.status === 'OFFLINE';
    const model = motors.find((each) => each.name === props.motor)?.model ?? '';
    const name = silent && isOfKind(model, drive.kind) ? props.motor : `motor_${drive.id}`;
    setChosen({ name, model: modelsOf(drive.kind)[0] ?? '', id: drive.id, own: drive.own });
  };
  return (
    <>
      <p>{word('comBusScan')}</p>
      <div class="toolbar no-print">
        <button type="button" disabled={busy || known.hello?.right !== 'command'} onClick={() => void scan()}>
          {word('comScan')}
        </button>
        <CopyLines request={request} python={requestPython(request)} />
        <span aria-live="polite">{busy ? word('comScanning') : ''}</span>
        <Refusal why={answer === null || ok ? '' : answer.message} />
      </div>
      {ok && drives.length > 0 && <Drives drives={drives} onUse={use} />}
      {ok && (
        <ul class="notice">
          {drives.length === 0 && <li>{word('comScanNothing')}</li>}
          {unknown.map((each) => (
            <li key={`${each.extended} ${each.frame_id}`}>{`0x${each.frame_id.toString(16).toUpperCase()}: ${each.advice}`}</li>
          ))}
          {advice.map((line) => (
            <li key={line}>{line}</li>
          ))}
        </ul>
      )}
      {chosen !== null && (
        <NewMotor bus={props.bus} names={motors.map((each) => each.name)} chosen={chosen} text={props.text} onSet={setChosen} />
      )}
      <datalist id="scan-models">
        {[...new Set(drives.flatMap((drive) => modelsOf(drive.kind)))].map((model) => (
          <option key={model} value={model} />
        ))}
      </datalist>
    </>
  );
}
