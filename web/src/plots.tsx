import type { ComponentChildren } from 'preact';
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import type uPlot from 'uplot';

import { type Kept, type Mark, colourOf, makeChart } from './chart';
import { useKnown, useStored, useStudio } from './context';
import { download } from './download';
import { number, unitOf } from './numbers';
import { Refusal } from './refusal';
import { type Shown, SidePlots } from './side_plots';
import { type SignalsOf, SignalChooser } from './signal_chooser';
import { logOfTicks, saveMcap } from './signal_log';
import { kMostColumns, ticksOf } from './ticks';
import { Traces } from './traces';

const kSpans_s = [2, 5, 10, 30, 60];
const kUs = 1e6;

function allSignals(known: ReturnType<typeof useKnown>): SignalsOf[] {
  const robot = known.robot;
  if (robot === null) return [];
  return [
    ...robot.robot.motors.map((motor) => ({
      owner: motor.name,
      names: robot.readings.map((reading) => `${motor.name}.${reading}`),
    })),
    ...robot.modules.map((module) => ({
      owner: module.name,
      names: module.outputs.map((output) => `${module.name}.${output}`),
    })),
  ];
}

function firstChoice(known: ReturnType<typeof useKnown>): string[] {
  const motor = known.robot?.robot.motors[0]?.name;
  return motor === undefined ? [] : [`${motor}.velocity_rpm`, `${motor}.current_a`];
}

export function Plots() {
  const known = useKnown();
  const [stored, setChosen] = useStored<string[]>('signals', []);
  const owners = allSignals(known);
  // Those of another robot, or of a file before, are not this one's.
  const all = new Set(owners.flatMap((owner) => owner.names));
  const here = stored.filter((name) => all.has(name));
  const chosen = here.length === 0 ? firstChoice(known) : here;
  return (
    <div class="plots">
      <SignalChooser owners={owners} chosen={chosen} onChoose={setChosen} />
      <Curves signals={chosen} below={(shown) => <SidePlots shown={shown} />} />
    </div>
  );
}

/** Curves of these signals, each tick in them, and what can be done with them. */
export function Curves(props: {
  signals: string[];
  unit?: (signal: string) => string;
  below?: (shown: Shown) => ComponentChildren;
}) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [span_s, setSpan] = useStored('span_s', 10);
  const [frozen, setFrozen] = useState(false);
  const [points, setPoints] = useState<number[]>([]);
  const [kept, setKept] = useState<Kept[]>([]);
  const [drawn, setDrawn] = useState<string[]>([]);
  const [notDrawn, setNotDrawn] = useState<string[]>([]);
  const [droppedTicks, setDroppedTicks] = useState(0);
  const [saving, setSaving] = useState(false);
  const [notSaved, setNotSaved] = useState('');
  const [filled, setFilled] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  const chart = useRef<uPlot | null>(null);
  const view = useRef(0);
  const waiting = useRef(0);
  const origin = useRef(0);
  const zoomed = useRef({ first: -1, columnUs: 0 });
  const wall_us = useRef<number | null>(null);
  const pointsNow = useRef<number[]>([]);
  const keptNow = useRef<Kept[]>([]);
  const frozenNow = useRef(false);
  pointsNow.current = points;
  keptNow.current = kept;
  frozenNow.current = frozen;
  if (known.state !== null) wall_us.current = known.state.data.utime - known.state.data.mono_us;
  // Another start of rc10d, or a module that is known now: rc10-web has no view of it.
  const { robot } = known;
  const source = robot === null ? '' : [robot.robot.robot, robot.robot.pid, ...robot.modules.map((each) => each.outputs.length)].join(' ');
  const chosen = props.signals;
  const unit = props.unit ?? unitOf;
  const key = chosen.map((name) => name + unit(name)).join(' ');
  const traces = useMemo(() => new Traces(() => origin.current), [key, span_s, source]);

  const columns = () => Math.min(2000, Math.max(200, Math.round(box.current?.clientWidth ?? 800)));

  // A picture for each that the screen shows, however often something comes.
  const drawSoon = () => {
    if (waiting.current !== 0) return;
    waiting.current = requestAnimationFrame(() => {
      waiting.current = 0;
      if (!frozenNow.current) draw();
    });
  };

  const draw = () => {
    const u = chart.current;
    // A picture that was waiting is of other signals than the chart that came since.
    if (u === null || u.series.length !== 1 + 2 * traces.min.length) return;
    const data = [traces.times, ...traces.min.flatMap((min, i) => [min, traces.max[i] ?? []])];
    u.batch(() => {
      u.setData(data as unknown as uPlot.AlignedData, false);
      const end = traces.times[traces.times.length - 1] ?? 0;
      if (!frozenNow.current) u.setScale('x', { min: end - span_s, max: end });
      else u.redraw();
    });
    setFilled(traces.times.length > 0);
  };

  // The chart is made anew for other signals; its data come with the answer.
  useEffect(() => {
    const target = box.current;
    if (target === null || chosen.length === 0 || robot === null) return;
    const columnUs = Math.max(100, Math.round((span_s * kUs) / columns()));
    const marks = (): Mark[] => [
      ...link.known.events.slice(0, 60).map((event) => ({
        time: (event.mono_us - origin.current) / kUs,
        colour: event.severity === 'info' ? '#888888' : '#d55e00',
        text: event.source,
      })),
      ...pointsNow.current.map((time, i) => ({ time, colour: '#cc79a7', text: i === 0 ? 'A' : 'B' })),
    ];
    setPoints([]);
    setFrozen(false);
    setFilled(false);
    const number_ = link.view(chosen, columnUs, span_s * kUs);
    view.current = number_;
    link.onView = (answer) => {
      if (answer.view !== number_) return;
      setDroppedTicks(answer.dropped_ticks);
      setDrawn(answer.signals);
      setNotDrawn(answer.unknown);
      chart.current?.destroy();
      chart.current = makeChart(target, answer.signals, {
        marks,
        kept: () => keptNow.current,
        unit,
        onClick: (time) => setPoints((before) => (before.length >= 2 ? [time] : [...before, time])),
        onSelect: (from, to) => zoom(from, to),
      });
    };
    const forget = link.addColumns((received) => {
      if (received.kind === 'reset' && received.count > 0 && origin.current === 0)
        origin.current = received.first * received.columnUs;
      if (received.kind === 'next' && origin.current === 0) origin.current = received.first * received.columnUs;
      if (received.kind === 'range') {
        // The answer to the last zoom, not to another's.
        if (received.first !== zoomed.current.first || received.columnUs !== zoomed.current.columnUs) return;
        const fine = new Traces(() => origin.current);
        if (!fine.add({ ...received, kind: 'reset' }, number_, received.count)) return;
        chart.current?.setData(
          [fine.times, ...fine.min.flatMap((min, i) => [min, fine.max[i] ?? []])] as unknown as uPlot.AlignedData,
          true,
        );
        return;
      }
      if (traces.add(received, number_, Math.ceil((60 * kUs) / received.columnUs)) && !frozenNow.current) drawSoon();
    });
    return () => {
      link.onView = () => {};
      forget();
      link.view([], 1000, 0);
      chart.current?.destroy();
      chart.current = null;
    };
  }, [key, span_s, source, known.hello]);

  // A narrower column shows what a wide one hides, as long as the server has it.
  const zoom = (from: number, to: number) => {
    setFrozen(true);
    frozenNow.current = true;
    const columnUs = Math.max(100, Math.round(((to - from) * kUs) / columns()));
    const first = Math.floor((from * kUs + origin.current) / columnUs);
    zoomed.current = { first, columnUs };
    link.range(first, columnUs, Math.min(kMostColumns, Math.ceil(((to - from) * kUs) / columnUs)));
  };

  useEffect(() => {
    const target = box.current;
    if (target === null) return;
    const observer = new ResizeObserver(() =>
      chart.current?.setSize({ width: Math.max(280, target.clientWidth), height: Math.max(240, target.clientHeight) }),
    );
    observer.observe(target);
    return () => observer.disconnect();
  }, []);

  useEffect(() => chart.current?.redraw(), [points, kept]);

  const valueAt = (signal: number, time: number): number | null => {
    const times = chart.current?.data[0] ?? [];
    const values = chart.current?.data[2 * signal + 2] ?? [];
    let best: number | null = null;
    for (let i = 0; i < times.length && (times[i] ?? 0) <= time; ++i) best = values[i] ?? best;
    return best;
  };

  const csv = () => {
    const data = chart.current?.data ?? [[]];
    const lines = [['time_s', ...drawn.flatMap((name) => [`${name}.min`, `${name}.max`])].join(',')];
    for (let i = 0; i < (data[0]?.length ?? 0); ++i)
      lines.push(data.map((values) => values[i] ?? '').join(','));
    download('rc10.csv', new Blob([`${lines.join('\n')}\n`], { type: 'text/csv' }));
  };
  const png = () => chart.current?.ctx.canvas.toBlob((blob) => blob !== null && download('rc10.png', blob));

  const mcap = async () => {
    setSaving(true);
    setNotSaved(await whyNoMcap().catch((error: unknown) => `${word('mcapFailed')} ${String(error)}`));
    setSaving(false);
  };
  const whyNoMcap = async () => {
    const window = shownWindow();
    if (window === null || robot === null || wall_us.current === null) return word('mcapNone');
    const period_us = Math.round(kUs / robot.robot.rate_hz);
    const first = Math.max(0, Math.floor(window.from_us / period_us));
    const count = Math.floor(window.to_us / period_us) + 1 - first;
    const values = await ticksOf(link, { view: view.current, signals: drawn.length, first, count, period_us });
    if (values === null || values.every((row) => row.every(Number.isNaN))) return word('mcapNone');
    const signals = drawn.map((name, i) => ({ name, unit: unit(name), values: values[i] ?? [] }));
    await saveMcap('rc10.mcap', logOfTicks(robot, signals, first, period_us, wall_us.current));
    return '';
  };

  const keep = () =>
    setKept(drawn.map((name, i) => ({ name, times: [...traces.times], values: [...(traces.max[i] ?? [])] })));

  const shownWindow = () => {
    const x = chart.current?.scales['x'];
    if (x?.min === undefined || x.max === undefined || origin.current === 0) return null;
    return { from_us: x.min * kUs + origin.current, to_us: x.max * kUs + origin.current };
  };

  return (
    <div class="plot">
      <div class="toolbar">
        <label>
          {`${word('span')} `}
          <select value={span_s} onChange={(event) => setSpan(Number(event.currentTarget.value))}>
            {kSpans_s.map((seconds) => (
              <option key={seconds} value={seconds}>{`${seconds} s`}</option>
            ))}
          </select>
        </label>
        <button
          type="button"
          aria-pressed={frozen}
          onClick={() => {
            setFrozen(!frozen);
            frozenNow.current = !frozen;
            if (frozen) draw();
          }}
        >
          {frozen ? word('go') : word('freeze')}
        </button>
        <button type="button" onClick={draw}>
          {word('fit')}
        </button>
        <button type="button" onClick={kept.length > 0 ? () => setKept([]) : keep}>
          {kept.length > 0 ? word('forget') : word('keep')}
        </button>
        <button type="button" onClick={csv}>
          {word('csv')}
        </button>
        <button type="button" disabled={saving || !filled} onClick={() => void mcap()}>
          {word('mcap')}
        </button>
        <button type="button" onClick={png}>
          {word('png')}
        </button>
        <Refusal why={notSaved} />
        {droppedTicks > 0 && <span class="hint">{`${droppedTicks} ${word('droppedTicks')}`}</span>}
        {notDrawn.length > 0 && <span class="refused">{`${word('notDrawn')} ${notDrawn.join(', ')}`}</span>}
      </div>
      <div class="chart" ref={box} />
      <table class="legend">
        <tbody>
          {drawn.map((name, i) => {
            const at = points.map((time) => valueAt(i, time));
            const [a, b] = at;
            const last = traces.max[i]?.[traces.times.length - 1] ?? null;
            return (
              <tr key={name}>
                <td>
                  <span class="swatch" style={{ background: colourOf(i) }} />
                  {name}
                </td>
                <td class="number">{`${number(last, 2)} ${unit(name)}`}</td>
                {at.map((value, n) => (
                  <td key={n} class="number">{`${n === 0 ? 'A' : 'B'} ${number(value, 2)}`}</td>
                ))}
                {a !== undefined && b !== undefined && (
                  <td class="number">{`Δ ${number(a === null || b === null ? null : b - a, 2)}`}</td>
                )}
              </tr>
            );
          })}
        </tbody>
      </table>
      <p class="hint">
        {points.length === 2
          ? `Δt ${number(((points[1] ?? 0) - (points[0] ?? 0)) * 1000, 1)} ms`
          : word('cursor')}
      </p>
      {props.below?.({ signals: drawn, unit, window: shownWindow })}
    </div>
  );
}
