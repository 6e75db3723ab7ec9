// Beside the curves over time: one signal over another, and spectra.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import uPlot from 'uplot';

import { around, clipped, colourOf, dashOf, inkOf } from './chart';
import { useKnown, useStored, useStudio } from './context';
import { number } from './numbers';
import type { Columns } from './protocol';
import { type Spectrum, spectrumOf } from './spectrum';
import { kMostColumns } from './ticks';

/** Signals of the curves above, and the time that they show. */
export interface Shown {
  signals: string[];
  unit: (signal: string) => string;
  window: () => { from_us: number; to_us: number } | null;
}

const kUs = 1e6;
const kAskEveryMs = 500;
const kSizes = [256, 1024, 4096];

interface Ask {
  columnUs: number;
  first: number;
  count: number;
}

/** The middle of each column, by signal; asked for anew twice a second. */
function usePast(shown: Shown, ask: () => Ask | null): Float64Array[] {
  const { link } = useStudio();
  const [values, setValues] = useState<Float64Array[]>([]);
  const asked = useRef<Ask | null>(null);
  const askNow = useRef(ask);
  askNow.current = ask;
  const key = shown.signals.join(' ');
  useEffect(() => {
    setValues([]);
    const forget = link.addColumns((received: Columns) => {
      const wanted = asked.current;
      if (received.kind !== 'range' || wanted === null || received.min.length !== shown.signals.length) return;
      if (received.first !== wanted.first || received.columnUs !== wanted.columnUs) return;
      setValues(received.min.map((min, i) => Float64Array.from(min, (value, k) => (value + (received.max[i]?.[k] ?? NaN)) / 2)));
    });
    const send = () => {
      asked.current = askNow.current();
      const wanted = asked.current;
      if (wanted !== null && wanted.first >= 0) link.range(wanted.first, wanted.columnUs, wanted.count);
    };
    send();
    const timer = setInterval(send, kAskEveryMs);
    return () => {
      clearInterval(timer);
      forget();
    };
  }, [key, link]);
  return values;
}

function makeAxes(x: string, units: string[]): uPlot.Axis[] {
  const axis = { stroke: () => inkOf('--ink'), grid: { stroke: () => inkOf('--grid'), width: 1 }, ticks: { stroke: () => inkOf('--grid') } };
  return [
    { ...axis, label: x },
    ...units.map((unit, i) => ({ ...axis, scale: unit, label: unit, side: i % 2 === 0 ? 3 : 1, size: 64, grid: { ...axis.grid, show: i === 0 } })),
  ];
}

/** A chart in a box of its own, made anew for other signals, drawn anew for other data. */
function Chart(props: { label: string; signals: string; make: (box: HTMLElement) => uPlot; data: uPlot.AlignedData }) {
  const box = useRef<HTMLDivElement>(null);
  const chart = useRef<uPlot | null>(null);
  useEffect(() => {
    const target = box.current;
    if (target === null) return;
    const made = props.make(target);
    chart.current = made;
    const observer = new ResizeObserver(() => made.setSize(sizeOf(target)));
    observer.observe(target);
    return () => {
      observer.disconnect();
      made.destroy();
    };
  }, [props.signals]);
  useEffect(() => chart.current?.setData(props.data), [props.signals, props.data]);
  return <div class="chart side-chart" role="img" aria-label={props.label} ref={box} />;
}

function sizeOf(target: HTMLElement): { width: number; height: number } {
  return { width: Math.max(280, target.clientWidth), height: Math.max(240, target.clientHeight) };
}

const kNoLegend = { legend: { show: false }, cursor: { show: false } };

function SpectrumPlot(props: { shown: Shown }) {
  const { word } = useStudio();
  const known = useKnown();
  const [size, setSize] = useStored('fftSize', 1024);
  const { signals, unit } = props.shown;
  const rate_hz = known.robot?.robot.rate_hz ?? 1000;
  const columnUs = Math.round(kUs / rate_hz);
  const past = usePast(props.shown, () => {
    const window = props.shown.window();
    return window === null ? null : { columnUs, first: Math.floor(window.to_us / columnUs) - size, count: size };
  });
  const spectra = useMemo(
    () => past.map((values): Spectrum | null => (values.length === size ? spectrumOf(values, rate_hz) : null)),
    [past, size, rate_hz],
  );
  const data = useMemo(() => {
    const hz = Array.from({ length: size / 2 }, (_, k) => (k * rate_hz) / size);
    return [hz, ...signals.map((_, i) => spectra[i]?.amplitude ?? hz.map(() => null))] as unknown as uPlot.AlignedData;
  }, [spectra, signals]);
  const units = [...new Set(signals.map(unit))];
  return (
    <>
      <div class="toolbar">
        <label>
          {`${word('fftWindow')} `}
          <select value={size} onChange={(event) => setSize(Number(event.currentTarget.value))}>
            {kSizes.map((each) => (
              <option key={each} value={each}>{`${each} · ${number(each / rate_hz, 2)} s`}</option>
            ))}
          </select>
        </label>
        <span class="hint">{`Δf ${number(rate_hz / size, 2)} Hz`}</span>
      </div>
      <Chart
        label={word('fft')}
        signals={signals.map((name) => name + unit(name)).join(' ')}
        data={data}
        make={(box) =>
          new uPlot(
            {
              ...sizeOf(box),
              ...kNoLegend,
              series: [
                {},
                ...signals.map((name, i) => ({ label: name, scale: unit(name), stroke: colourOf(i), dash: dashOf(i), width: 1.5, points: { show: false } })),
              ],
              scales: { x: { time: false }, ...Object.fromEntries(units.map((each) => [each, { range: around }])) },
              axes: makeAxes('Hz', units),
            },
            [[], ...signals.map(() => [])] as unknown as uPlot.AlignedData,
            box,
          )
        }
      />
      <table class="legend peaks">
        <tbody>
          {signals.map((name, i) => {
            const peak = spectra[i]?.peak ?? null;
            return (
              <tr key={name}>
                <td>
                  <span class="swatch" style={{ background: colourOf(i) }} />
                  {name}
                </td>
                <td class="number">{peak === null ? '–' : `${number(peak.hz, 2)} Hz`}</td>
                <td class="number">{peak === null ? '–' : `${number(peak.amplitude, 3)} ${unit(name)}`}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
      <p class="hint">{past.length > 0 && spectra.every((each) => each === null) ? word('fftMissing') : word('fftHint')}</p>
    </>
  );
}

function extent(values: Float64Array | undefined): [number, number] | null {
  let least = Infinity;
  let greatest = -Infinity;
  for (const value of values ?? []) {
    if (Number.isNaN(value)) continue;
    least = Math.min(least, value);
    greatest = Math.max(greatest, value);
  }
  return least <= greatest ? [least, greatest] : null;
}

function drawPath(u: uPlot, xs: Float64Array, ys: Float64Array, colour: string): void {
  clipped(u, (context) => {
    context.strokeStyle = colour;
    context.lineWidth = 1.5 * devicePixelRatio;
    context.beginPath();
    let down = false;
    for (let i = 0; i < xs.length; ++i) {
      const x = xs[i] ?? NaN;
      const y = ys[i] ?? NaN;
      // A late tick leaves its column empty: the line goes on.
      if (Number.isNaN(x) || Number.isNaN(y)) continue;
      const at = [u.valToPos(x, 'x', true), u.valToPos(y, 'y', true)] as const;
      if (down) context.lineTo(...at);
      else context.moveTo(...at);
      down = true;
    }
    context.stroke();
  });
}

function XyPlot(props: { shown: Shown }) {
  const { word } = useStudio();
  const known = useKnown();
  const [stored, setStored] = useStored<{ x: string; y: string }>('xy', { x: '', y: '' });
  const { signals, unit } = props.shown;
  const tickUs = Math.round(kUs / (known.robot?.robot.rate_hz ?? 1000));
  const past = usePast(props.shown, () => {
    const window = props.shown.window();
    if (window === null) return null;
    const span_us = window.to_us - window.from_us;
    // Each tick, as far as one answer has room.
    const columnUs = Math.max(tickUs, Math.ceil(span_us / (kMostColumns - 1)));
    return { columnUs, first: Math.floor(window.from_us / columnUs), count: Math.min(kMostColumns, Math.max(1, Math.ceil(span_us / columnUs))) };
  });
  const x = signals.includes(stored.x) ? stored.x : (signals[0] ?? '');
  const y = signals.includes(stored.y) ? stored.y : (signals[1] ?? signals[0] ?? '');
  const xs = past[signals.indexOf(x)];
  const ys = past[signals.indexOf(y)];
  const path = useRef<{ xs: Float64Array; ys: Float64Array } | null>(null);
  path.current = xs !== undefined && ys !== undefined ? { xs, ys } : null;
  const ranges = useMemo(() => ({ x: extent(xs), y: extent(ys) }), [xs, ys]);
  const corners = useMemo((): uPlot.AlignedData => [ranges.x ?? [], ranges.y ?? []], [ranges]);
  const chooser = (axis: 'x' | 'y', value: string) => (
    <label>
      {`${axis.toUpperCase()} `}
      <select value={value} onChange={(event) => setStored({ x, y, [axis]: event.currentTarget.value })}>
        {signals.map((name) => (
          <option key={name}>{name}</option>
        ))}
      </select>
    </label>
  );
  const told = (name: string, range: [number, number] | null) =>
    range === null ? '' : `${name} ${number(range[0], 2)} … ${number(range[1], 2)} ${unit(name)}`;
  return (
    <>
      <div class="toolbar">
        {chooser('x', x)}
        {chooser('y', y)}
      </div>
      <Chart
        label={word('xy')}
        signals={`${x} ${y}`}
        data={corners}
        make={(box) =>
          new uPlot(
            {
              ...sizeOf(box),
              ...kNoLegend,
              // The corners of the path, for the scales; it is drawn over them.
              series: [{}, { stroke: 'transparent', points: { show: false } }],
              scales: { x: { time: false, range: around }, y: { range: around } },
              axes: makeAxes(`${x} ${unit(x)}`, ['y']).map((axis, i) => (i === 1 ? { ...axis, label: `${y} ${unit(y)}` } : axis)),
              hooks: { draw: [(u) => path.current !== null && drawPath(u, path.current.xs, path.current.ys, colourOf(0))] },
            },
            [[], []],
            box,
          )
        }
      />
      <p class="hint">{[told(x, ranges.x), told(y, ranges.y)].filter((text) => text !== '').join('; ')}</p>
    </>
  );
}

const kKinds = { xy: XyPlot, fft: SpectrumPlot } as const;
type Kind = keyof typeof kKinds;

export function SidePlots(props: { shown: Shown }) {
  const { word } = useStudio();
  const [kind, setKind] = useStored<Kind | ''>('sidePlot', '');
  const Drawn = kind === '' ? null : kKinds[kind];
  return (
    <section class="side-plots">
      <div class="toolbar">
        {(Object.keys(kKinds) as Kind[]).map((each) => (
          <button type="button" key={each} aria-pressed={kind === each} onClick={() => setKind(kind === each ? '' : each)}>
            {word(each)}
          </button>
        ))}
      </div>
      {Drawn !== null && props.shown.signals.length > 0 && <Drawn shown={props.shown} />}
    </section>
  );
}
