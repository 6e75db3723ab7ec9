// The end of commissioning: the file's lines, and a report to print.
import { useState } from 'preact/hooks';

import type { StepProps } from './commission';
import { holdsNow, kSteps } from './commission_record';
import { putIntoDraft } from './config_draft';
import { useStudio } from './context';
import { download } from './download';
import type { MotorInfo, Robot } from './protocol';
import { Refusal } from './refusal';
import { filled, kStepWords } from './words_commission';
import { withMotorKeys } from './yaml_motor';

export function CommissionEnd(props: StepProps & { robot: Robot; info: MotorInfo; text: string | null }) {
  const { word } = useStudio();
  const [told, setTold] = useState('');
  const { record, robot, info } = props;
  const keys = Object.fromEntries(Object.entries(record.lines).filter(([, value]) => value !== undefined)) as Record<string, number>;
  const lines = Object.entries(keys).map(([key, value]) => `${key}: ${value}`);
  const rows = kSteps.flatMap((step) => {
    if (step === 'end') return [];
    const finding = record.found[step];
    const now = holdsNow(step, finding, robot);
    const sign = finding === undefined ? '○' : !now ? '↺' : finding.good ? '✓' : '✗';
    const text = finding === undefined ? word('comNotDone') : `${filled(word(finding.word), finding.values)}${now ? '' : ` ${word('comOld')}`}`;
    return [{ step, sign, text, at: finding === undefined ? '' : new Date(finding.at).toLocaleString(undefined, { hour12: false }) }];
  });
  const report = [
    `${word('comReport')}: ${robot.robot.robot}, ${info.name} (${info.model}, ${info.bus}, id ${info.id})`,
    `SHA-256 ${robot.robot.config_hash}`,
    `rc10d ${robot.robot.version}`,
    '',
    ...rows.map((row) => `${row.sign} ${word(kStepWords[row.step])}: ${row.text}${row.at === '' ? '' : ` [${row.at}]`}`),
    '',
    ...(lines.length === 0 ? [word('comNoLines')] : [`# ${word('comLines')} ${info.name}`, ...lines]),
    '',
  ].join('\n');

  const put = () => {
    const change = (text: string) => withMotorKeys(text, info.name, keys);
    if (props.text === null || !putIntoDraft(props.text, change, `${word('commission')}: ${info.name}`)) setTold(word('comNotPut'));
  };
  return (
    <>
      <div class="report" aria-label={word('comReport')} role="group">
        <p>{`${robot.robot.robot} · ${info.name} · ${info.model} · ${info.bus} · id ${info.id} · ${robot.robot.config_hash.slice(0, 12)}`}</p>
        <table class="checks">
          <tbody>
            {rows.map((row) => (
              <tr key={row.step} class={row.sign === '✓' ? 'good' : row.sign === '✗' ? 'bad' : ''}>
                <td class="sign">{row.sign}</td>
                <th scope="row">{word(kStepWords[row.step])}</th>
                <td>
                  {row.text} <span class="hint">{row.at}</span>
                </td>
              </tr>
            ))}
          </tbody>
        </table>
        <h3>{`${word('comLines')} ${info.name}`}</h3>
        {lines.length === 0 ? <p>{word('comNoLines')}</p> : <pre aria-label={word('comLines')}>{lines.join('\n')}</pre>}
      </div>
      <div class="toolbar no-print">
        <button type="button" disabled={lines.length === 0} onClick={() => void navigator.clipboard?.writeText(lines.join('\n'))}>
          {word('gainsCopy')}
        </button>
        <button type="button" class="strong" disabled={lines.length === 0 || props.text === null} onClick={put}>
          {word('comPut')}
        </button>
        <button type="button" onClick={() => window.print()}>
          {word('comPrint')}
        </button>
        <button type="button" onClick={() => download(`${robot.robot.robot}-${info.name}.txt`, new Blob([report], { type: 'text/plain' }))}>
          {word('comSave')}
        </button>
        <Refusal why={told} />
      </div>
      <p class="hint no-print">{word('comAfter')}</p>
    </>
  );
}
