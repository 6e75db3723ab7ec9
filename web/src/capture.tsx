// Armed, it takes every tick around a trigger; what was taken lies over one another.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import uPlot from 'uplot';

import { remember, remembered } from './browser_memory';
import { type Capture, capturesIn, fileOf, isOfOtherVersion, kMostFileBytes, newestWithin, responseOf, stepNumbers, timesOf } from './captures';
import { colourOf } from './chart';
import { useKnown, useStored, useStudio } from './context';
import { download } from './download';
import { FileButton } from './file_button';
import { NumberField } from './number_field';
import { number } from './numbers';
import type { Columns } from './protocol';
import { Refusal } from './refusal';
import { logOfCapture, saveMcap } from './signal_log';
import { kMostColumns } from './ticks';
import { filled } from './words_commission';

type Edge = 'rising' | 'falling' | 'event';

interface Trigger {
  edge: Edge;
  level: number;
  pre_s: number;
  length_s: number;
}
const kFirst: Trigger = { edge: 'rising', level: 5, pre_s: 0.2, length_s: 1 };
const kMost_s = 10;
const kUs = 1e6;
// Browsers remember some 5 million characters of a page.
const kMostKept = 5e6;

/** Captures in this browser, and the number of those for which it has no room: the oldest, which this page still has. */
function useCaptures(): [Capture[], (captures: Capture[]) => void, number] {
  const key = 'rc10.captures';
  const [captures, set] = useState<Capture[]>(() => capturesIn(remembered(key) ?? '') ?? []);
  const [forgotten, setForgotten] = useState(0);
  return [
    captures,
    (next) => {
      let kept = newestWithin(next, kMostKept);
      while (!remember(key, fileOf(kept)) && kept.length > 0) kept = kept.slice(1);
      setForgotten(next.length - kept.length);
      set(next);
    },
    forgotten,
  ];
}

/** First moment in these columns at which the signal crosses the level, in µs; null: none. */
function crossing(columns: Columns, signal: number, trigger: Trigger, before: { value: number | null }): number | null {
  for (let i = 0; i < columns.count; ++i) {
    const low = columns.min[signal]?.[i] ?? NaN;
    const high = columns.max[signal]?.[i] ?? NaN;
    const was = before.value;
    // No target is none that has been reached.
    if (Number.isNaN(low)) before.value = trigger.edge === 'rising' ? -Infinity : Infinity;
    else before.value = trigger.edge === 'rising' ? high : low;
    if (Number.isNaN(low)) continue;
    if (was === null) continue;
    const crossed = trigger.edge === 'rising' ? was < trigger.level && high >= trigger.level : was > trigger.level && low <= trigger.level;
    if (crossed) return (columns.first + i) * columns.columnUs;
  }
  return null;
}

/** Capture under way: the trigger, and the columns of one tick each that rc10-web is asked for. */
interface Taking {
  trigger_us: number;
  first: number;
  count: number;
  period_us: number;
  /** Largest distance of the trigger's tick from `trigger_us`. */
  within_us: number;
  names: string[];
  units: string[];
  gains: Promise<Record<string, number>>;
  /** Values by signal, as far as they have come. */
  values: (number | null)[][];
  /** Time of the last request for columns; 0: none yet. */
  asked_ms: number;
}
const kAskAgainMs = 1000;

/** Captures over one another, at the moment of their triggers. */
export function Overlay(props: { captures: Capture[]; colours: Map<string, string> }) {
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const target = box.current;
    if (target === null || props.captures.length === 0) return;
    const tables: uPlot.AlignedData[] = props.captures.map((capture) => [timesOf(capture), ...capture.values] as uPlot.AlignedData);
    const data = uPlot.join(tables);
    const ink = getComputedStyle(document.documentElement).getPropertyValue('--ink').trim();
    const grid = getComputedStyle(document.documentElement).getPropertyValue('--grid').trim();
    const units = [...new Set(props.captures.flatMap((capture) => capture.units))];
    const series: uPlot.Series[] = [{}];
    for (const capture of props.captures)
      capture.signals.forEach((signal, i) =>
        series.push({
          label: signal,
          scale: capture.units[i] ?? '',
          stroke: props.colours.get(capture.id) ?? colourOf(0),
          dash: i === 0 ? [6, 4] : i === responseOf(capture) ? [] : [2, 3],
          width: i === responseOf(capture) ? 2 : 1,
          points: { show: false },
          spanGaps: true,
        }),
      );
    const axis = { stroke: ink, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid } };
    const size = () => ({ width: Math.max(280, target.clientWidth), height: 320 });
    const chart = new uPlot(
      {
        ...size(),
        series,
        scales: { x: { time: false } },
        axes: [
          { ...axis, values: (_u, values) => values.map((value) => `${value} s`) },
          ...units.map((unit, i) => ({ ...axis, scale: unit, side: i % 2 === 0 ? 3 : 1, size: 64, label: unit, grid: { ...axis.grid, show: i === 0 } })),
        ],
        legend: { show: false },
      },
      data,
      target,
    );
    const observer = new ResizeObserver(() => chart.setSize(size()));
    observer.observe(target);
    return () => {
      observer.disconnect();
      chart.destroy();
    };
  }, [props.captures]);
  return <div class="overlay" ref={box} />;
}

export function CapturePanel(props: { motor: string; unit: (signal: string) => string }) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [trigger, setTrigger] = useStored<Trigger>('trigger', kFirst);
  const [signal, setSignal] = useState(0);
  const [captures, setCaptures, forgotten] = useCaptures();
  const [hidden, setHidden] = useState<string[]>([]);
  const [state, setState] = useState<'idle' | 'armed' | 'waiting'>('idle');
  const [told, setTold] = useState('');
  const taking = useRef<Taking | null>(null);
  const armedAt = useRef(0);
  // At once, where the state is drawn later.
  const armed = useRef(false);
  const names = link.shown;
  const period_us = Math.round(kUs / (known.robot?.robot.rate_hz ?? 1000));
  const colours = new Map(captures.map((capture, i) => [capture.id, colourOf(i)]));
  // The same list as long as it is the same choice: another one is another chart.
  const overlaid = useMemo(() => captures.filter((capture) => !hidden.includes(capture.id)), [captures, hidden]);
  const latest = useRef({ captures, trigger, names });
  latest.current = { captures, trigger, names };

  const disarm = () => {
    armed.current = false;
    taking.current = null;
    setState('idle');
  };

  const begin = (trigger_us: number, within_us: number) => {
    const { pre_s, length_s } = latest.current.trigger;
    const asked = link.ask({ operation: 'get_config', target: props.motor });
    taking.current = {
      trigger_us,
      first: Math.round((trigger_us - pre_s * kUs) / period_us),
      count: Math.max(1, Math.round(((pre_s + length_s) * kUs) / period_us)),
      period_us,
      within_us,
      names: latest.current.names,
      units: latest.current.names.map(props.unit),
      gains: asked.then((answer) => (answer.status === 'ok' ? answer.values : {})),
      values: [],
      asked_ms: 0,
    };
    setState('waiting');
  };

  const askNext = (now: Taking) => {
    const got = now.values[0]?.length ?? 0;
    now.asked_ms = performance.now();
    link.range(now.first + got, now.period_us, Math.min(kMostColumns, now.count - got));
  };

  const collect = (columns: Columns, now: Taking) => {
    if (columns.columnUs !== now.period_us || columns.first !== now.first + (now.values[0]?.length ?? 0)) return;
    const piece = columns.min.map((row) => [...row].map((value) => (Number.isNaN(value) ? null : value)));
    now.values = piece.map((row, i) => [...(now.values[i] ?? []), ...row]);
    if ((now.values[0]?.length ?? 0) < now.count) askNext(now);
    else void take(now);
  };

  const take = async (taken: Taking) => {
    disarm();
    const gains = await taken.gains;
    const { pre_s, edge, level } = latest.current.trigger;
    const values = taken.values;
    // The column in which the trigger was seen is wider than a tick: the tick itself is looked for here.
    let at = Math.round(pre_s * (kUs / period_us));
    if (edge !== 'event') {
      const row = values[signal] ?? [];
      const crosses = (i: number) => {
        const was = row[i - 1];
        const is = row[i];
        if (was === undefined || is === undefined || is === null) return false;
        return edge === 'rising' ? (was ?? -Infinity) < level && is >= level : (was ?? Infinity) > level && is <= level;
      };
      const reach = Math.ceil(taken.within_us / period_us) + 1;
      const found = row.findIndex((_, i) => i > 0 && Math.abs(i - at) <= reach && crosses(i));
      if (found > 0) at = found;
    }
    const capture: Capture = {
      id: `${Date.now()}`,
      name: `${props.motor} ${latest.current.captures.length + 1}`,
      taken: new Date().toISOString(),
      robot: known.robot?.robot.robot ?? '',
      config_hash: known.robot?.robot.config_hash ?? '',
      gains,
      signals: taken.names,
      units: taken.units,
      period_s: period_us / kUs,
      pre_s: at * (period_us / kUs),
      values,
    };
    setCaptures([...latest.current.captures, capture]);
  };

  useEffect(() => {
    if (state === 'idle') return;
    const before = { value: null as number | null };
    return link.addColumns((columns) => {
      const now = taking.current;
      if (columns.kind === 'range') {
        if (now !== null) collect(columns, now);
        return;
      }
      if (!armed.current) return;
      // The past, drawn anew: no trigger is looked for in it.
      if (columns.kind === 'reset') {
        before.value = null;
        return;
      }
      const end_us = (columns.first + columns.count) * columns.columnUs;
      if (now === null) {
        const event = link.known.events.find((each) => each.severity !== 'info' && each.mono_us > armedAt.current);
        if (trigger.edge === 'event') {
          if (event !== undefined) begin(event.mono_us, 0);
          return;
        }
        const at = crossing(columns, signal, trigger, before);
        if (at !== null && at > armedAt.current) begin(at, columns.columnUs);
      } else if (end_us >= (now.first + now.count) * now.period_us + columns.columnUs) {
        if (now.asked_ms === 0 || performance.now() - now.asked_ms > kAskAgainMs) askNext(now);
      }
    });
  }, [state, signal, trigger]);
  // Signals of another motor: what is under way means nothing any more.
  useEffect(disarm, [props.motor, names.join(' ')]);

  const arm = () => {
    armedAt.current = known.state?.data.mono_us ?? 0;
    armed.current = true;
    setTold('');
    setState('armed');
  };
  const saveAsMcap = (capture: Capture) =>
    saveMcap(`rc10-${capture.name.replace(/[^\p{L}\p{N}_-]+/gu, '-')}.mcap`, logOfCapture(capture, known.robot?.modules.map((module) => module.name) ?? [])).then(
      () => setTold(''),
      (error: unknown) => setTold(`${word('mcapFailed')} ${String(error)}`),
    );
  const save = (which: Capture[]) => download('rc10-captures.json', new Blob([fileOf(which)], { type: 'application/json' }));
  const open = async (file: File) => {
    if (file.size > kMostFileBytes) return setTold(word('captureTooLarge'));
    const text = await file.text();
    const found = capturesIn(text);
    if (found === null) return setTold(word(isOfOtherVersion(text) ? 'captureOtherVersion' : 'captureNoFile'));
    const ids = new Set(found.map((capture) => capture.id));
    setTold('');
    setCaptures([...captures.filter((capture) => !ids.has(capture.id)), ...found]);
  };
  const field = (key: 'level' | 'pre_s' | 'length_s', label: string, unit: string, least?: number) => (
    <label>
      {`${label} `}
      <NumberField
        least={least}
        value={trigger[key]}
        disabled={state !== 'idle'}
        onValue={(value) => setTrigger({ ...trigger, [key]: key === 'level' ? value : Math.min(kMost_s, Math.max(0, value)) })}
      />
      {` ${unit}`}
    </label>
  );

  return (
    <section class="card captures" aria-label={word('captures')}>
      <h3>{word('captures')}</h3>
      <div class="toolbar">
        <label>
          {`${word('captureWhen')} `}
          <select
            value={signal}
            disabled={state !== 'idle' || trigger.edge === 'event'}
            onChange={(event) => setSignal(Number(event.currentTarget.value))}
          >
            {names.map((name, i) => (
              <option key={name} value={i}>
                {name}
              </option>
            ))}
          </select>
        </label>
        <select
          aria-label={word('captureEdge')}
          value={trigger.edge}
          disabled={state !== 'idle'}
          onChange={(event) => setTrigger({ ...trigger, edge: event.currentTarget.value as Edge })}
        >
          <option value="rising">{word('captureRising')}</option>
          <option value="falling">{word('captureFalling')}</option>
          <option value="event">{word('captureEvent')}</option>
        </select>
        {trigger.edge !== 'event' && field('level', word('captureLevel'), props.unit(names[signal] ?? ''))}
        {field('pre_s', word('capturePre'), 's', 0)}
        {field('length_s', word('captureLength'), 's', 0)}
        <button type="button" class="strong" aria-pressed={state !== 'idle'} disabled={known.state === null} onClick={() => (state === 'idle' ? arm() : disarm())}>
          {state === 'idle' ? word('captureArm') : word('captureDisarm')}
        </button>
        <span class="hint" role="status">
          {state === 'armed' ? word('captureArmed') : state === 'waiting' ? word('captureWaiting') : ''}
        </span>
      </div>
      <div class="toolbar">
        <button type="button" disabled={captures.length === 0} onClick={() => save(captures)}>
          {word('captureSave')}
        </button>
        <FileButton text={word('captureOpen')} accept="application/json,.json" onFile={(file) => void open(file)} />
        <Refusal why={told} />
      </div>
      {forgotten > 0 && (
        <p class="refused" role="alert">
          {filled(word('captureNoRoom'), { n: `${forgotten}` })}
        </p>
      )}
      {captures.length > 0 && (
        <div class="scroll">
          <table class="timing">
            <thead>
              <tr>
                {(['captureName', 'captureStep', 'captureRise', 'captureOvershoot', 'captureSettling', 'captureError'] as const).map((key) => (
                  <th key={key}>{word(key)}</th>
                ))}
                <th />
              </tr>
            </thead>
            <tbody>
              {captures.map((capture) => {
                const step = stepNumbers(capture);
                const unit = capture.units[0] ?? '';
                const milliseconds = (value: number | null | undefined) =>
                  value === null || value === undefined ? '–' : `${number(value * 1000, 0)} ms`;
                return (
                  <tr key={capture.id} title={`${capture.robot} ${capture.taken} ${capture.config_hash.slice(0, 12)}`}>
                    <td>
                      <label>
                        <input
                          type="checkbox"
                          checked={!hidden.includes(capture.id)}
                          onChange={() =>
                            setHidden(hidden.includes(capture.id) ? hidden.filter((id) => id !== capture.id) : [...hidden, capture.id])
                          }
                          aria-label={`${word('show')} ${capture.name}`}
                        />
                        <span class="swatch" style={{ background: colours.get(capture.id) }} />
                      </label>
                      <input
                        class="capture-name"
                        aria-label={word('captureName')}
                        value={capture.name}
                        onInput={(event) =>
                          setCaptures(captures.map((each) => (each.id === capture.id ? { ...each, name: event.currentTarget.value } : each)))
                        }
                      />
                    </td>
                    <td class="number">{step === null ? '–' : `${number(step.from, 1)} → ${number(step.to, 1)} ${unit}`}</td>
                    <td class="number">{milliseconds(step?.rise_s)}</td>
                    <td class="number">{step?.overshoot === null || step === null ? '–' : `${number(100 * step.overshoot, 1)} %`}</td>
                    <td class="number">{milliseconds(step?.settling_s)}</td>
                    <td class="number">{step === null ? '–' : `${number(step.error, 2)} ${unit}`}</td>
                    <td>
                      <button type="button" onClick={() => save([capture])} aria-label={`${word('captureSave')} ${capture.name}`}>
                        ⤓
                      </button>
                      <button type="button" onClick={() => void saveAsMcap(capture)} aria-label={`${word('mcap')} ${capture.name}`}>
                        {word('mcap')}
                      </button>
                      <button
                        type="button"
                        onClick={() => setCaptures(captures.filter((each) => each.id !== capture.id))}
                        aria-label={`${word('captureRemove')} ${capture.name}`}
                      >
                        ✕
                      </button>
                    </td>
                  </tr>
                );
              })}
            </tbody>
          </table>
        </div>
      )}
      <Overlay captures={overlaid} colours={colours} />
      <p class="hint">{word('captureHint')}</p>
    </section>
  );
}
