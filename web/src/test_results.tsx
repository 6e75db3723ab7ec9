// Tests of motion beside one another: their curves, their Bode plots and their numbers.
import { useMemo, useState } from 'preact/hooks';

import { Bode } from './bode';
import { Overlay } from './capture';
import { colourOf } from './chart';
import { useStudio } from './context';
import { download } from './download';
import { type TestResult, bodeCsv, captureOf, curveCsv } from './motion_test';
import { number } from './numbers';
import type { Word } from './words';

const withUnit = (value: number | null | undefined, digits: number, unit: string) =>
  value === null || value === undefined ? '' : `${number(value, digits)} ${unit}`.trim();
const milliseconds = (value_s: number | null | undefined) =>
  value_s === null || value_s === undefined ? '' : withUnit(value_s * 1000, 0, 'ms');
const at = (value: string, hz: number | null) => (value === '' || hz === null ? value : `${value} @ ${number(hz, 1)} Hz`);

/** A row of the table; "": the test has no such number. */
const kNumbers: [Word, (result: TestResult) => string][] = [
  ['testRise', ({ report }) => milliseconds(report.step?.rise_s)],
  ['captureOvershoot', ({ report }) => withUnit(report.step?.overshoot_percent, 1, '%')],
  ['testSettling', ({ report }) => milliseconds(report.step?.settling_s)],
  ['captureError', ({ report }) => withUnit(report.step?.steady_error, 2, report.unit)],
  ['testAcceleration', ({ report }) => withUnit(report.acceleration_rpm_per_s, 0, 'rpm/s')],
  ['testBandwidth', ({ report }) => withUnit(report.bandwidth_hz, 1, 'Hz')],
  ['testPhaseMargin', ({ report }) => at(withUnit(report.phase_margin_deg, 1, '°'), report.phase_margin_at_hz)],
  ['testGainMargin', ({ report }) => at(withUnit(report.gain_margin_db, 1, 'dB'), report.gain_margin_at_hz)],
  ['testFollowing', ({ report }) => withUnit(report.following_error.rms, 2, report.unit)],
  ['testFollowingMost', ({ report }) => withUnit(report.following_error.max, 2, report.unit)],
  ['testSpeed', ({ report }) => withUnit(report.largest_velocity_rpm, 1, 'rpm')],
  ['testCurrent', ({ report }) => withUnit(report.largest_current_a, 2, 'A')],
  ['testLimits', ({ report }) => report.limits.join(', ')],
  ['testEnded', ({ report }) => (report.abort === null ? '' : report.abort.criterion)],
];

/** Gains that differ between these results, and those alone. */
function differing(results: TestResult[]): string[] {
  const keys = [...new Set(results.flatMap((result) => Object.keys(result.gains)))];
  return keys.filter((key) => new Set(results.map((result) => result.gains[key])).size > 1);
}

export function TestResults(props: { results: TestResult[]; onRemove: (id: string) => void }) {
  const { word } = useStudio();
  const [hidden, setHidden] = useState<string[]>([]);
  const { results } = props;
  const colours = useMemo(() => new Map(results.map((result, i) => [result.id, colourOf(i)])), [results]);
  const shown = useMemo(() => results.filter((result) => !hidden.includes(result.id)), [results, hidden]);
  // A step and a sweep, or rpm and degrees, are not drawn over one another: the newest one decides.
  const like = shown[shown.length - 1];
  const drawn = useMemo(
    () => shown.filter((result) => result.report.kind === like?.report.kind && result.report.mode === like?.report.mode),
    [shown],
  );
  const captures = useMemo(() => drawn.map(captureOf), [drawn]);
  const responses = useMemo(() => drawn.filter((result) => result.report.response.length > 0), [drawn]);
  if (results.length === 0) return null;
  const rows = kNumbers.filter(([, of]) => results.some((result) => of(result) !== ''));
  const save = (name: string, text: string) => download(name, new Blob([text], { type: 'text/csv' }));
  return (
    <section class="card tests" aria-label={word('testResults')}>
      <h3>{word('testResults')}</h3>
      <Overlay captures={captures} colours={colours} />
      {responses.length > 0 && <Bode results={responses} colours={colours} />}
      <div class="scroll">
        <table class="timing">
          <thead>
            <tr>
              <th>{word('captureName')}</th>
              {results.map((result) => (
                <th key={result.id} scope="col">
                  <label>
                    <input
                      type="checkbox"
                      checked={!hidden.includes(result.id)}
                      aria-label={`${word('show')} ${result.name}`}
                      onChange={() => setHidden(hidden.includes(result.id) ? hidden.filter((id) => id !== result.id) : [...hidden, result.id])}
                    />
                    <span class="swatch" style={{ background: colours.get(result.id) }} />
                    {result.name}
                  </label>
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {rows.map(([name, of]) => (
              <tr key={name}>
                <th scope="row">{word(name)}</th>
                {results.map((result) => (
                  <td key={result.id}>{of(result) === '' ? '–' : of(result)}</td>
                ))}
              </tr>
            ))}
            {differing(results).map((key) => (
              <tr key={key}>
                <th scope="row">{key}</th>
                {results.map((result) => (
                  <td key={result.id}>{result.gains[key] ?? '–'}</td>
                ))}
              </tr>
            ))}
            <tr>
              <th scope="row">{word('testFiles')}</th>
              {results.map((result) => (
                <td key={result.id}>
                  <button type="button" aria-label={`${word('csv')} ${result.name}`} onClick={() => save('rc10-test.csv', curveCsv(result))}>
                    {word('csv')}
                  </button>
                  {result.report.response.length > 0 && (
                    <button type="button" aria-label={`${word('bode')} ${result.name}`} onClick={() => save('rc10-bode.csv', bodeCsv(result))}>
                      {word('bode')}
                    </button>
                  )}
                  <button type="button" aria-label={`${word('captureRemove')} ${result.name}`} onClick={() => props.onRemove(result.id)}>
                    ✕
                  </button>
                </td>
              ))}
            </tr>
          </tbody>
        </table>
      </div>
      <p class="hint">{word('testHint')}</p>
    </section>
  );
}
