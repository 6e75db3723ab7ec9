// Curves of a recording.
import { useEffect, useRef } from 'preact/hooks';
import type uPlot from 'uplot';

import { type Mark, colourOf, makeChart } from './chart';
import { useStudio } from './context';
import { number, unitOf } from './numbers';
import type { Moment } from './recording_look';

const kUs = 1e6;

interface Picture {
  signals: string[];
  moment: Moment | null;
  from_us: number;
  to_us: number;
  at_us: number;
  whole: boolean;
  onAt: (at_us: number) => void;
  onShow: (from_us: number, to_us: number) => void;
  onWhole: () => void;
  onColumns: (columns: number) => void;
}

export function RecordedPlot(props: Picture) {
  const { word } = useStudio();
  const box = useRef<HTMLDivElement>(null);
  const chart = useRef<uPlot | null>(null);
  const now = useRef(props);
  now.current = props;
  const key = props.signals.join(' ');

  const draw = () => {
    const { moment, from_us, to_us, signals } = now.current;
    // The answer to an older choice of signals has others.
    if (chart.current === null || moment === null || moment.curves.min.length !== signals.length) return;
    const { times, min, max } = moment.curves;
    const u = chart.current;
    u.batch(() => {
      u.setData([times, ...min.flatMap((row, i) => [row, max[i] ?? []])] as unknown as uPlot.AlignedData, false);
      u.setScale('x', { min: from_us / kUs, max: to_us / kUs });
    });
  };

  useEffect(() => {
    const target = box.current;
    if (target === null) return;
    const marks = (): Mark[] => [
      ...(now.current.moment?.marks ?? []).map((mark) => ({
        time: mark.time_us / kUs,
        colour: mark.severity === 'info' ? '#888888' : '#d55e00',
        text: mark.source,
      })),
      { time: now.current.at_us / kUs, colour: '#cc79a7', text: '' },
    ];
    chart.current = makeChart(target, props.signals, {
      marks,
      kept: () => [],
      unit: unitOf,
      onClick: (time) => now.current.onAt(time * kUs),
      onSelect: (from, to) => now.current.onShow(Math.max(0, from * kUs), to * kUs),
    });
    const [times] = chart.current.axes;
    // As the slider counts: from the first record.
    if (times !== undefined) times.values = (_u, values) => values.map((value) => `${Number(value.toFixed(4))} s`);
    draw();
    return () => {
      chart.current?.destroy();
      chart.current = null;
    };
  }, [key]);
  useEffect(draw, [props.moment, props.from_us, props.to_us]);
  useEffect(() => chart.current?.redraw(), [props.at_us]);
  useEffect(() => {
    const target = box.current;
    if (target === null) return;
    const fit = () => {
      chart.current?.setSize({ width: Math.max(280, target.clientWidth), height: Math.max(240, target.clientHeight) });
      now.current.onColumns(Math.min(2000, Math.max(200, Math.round(target.clientWidth))));
    };
    const observer = new ResizeObserver(fit);
    observer.observe(target);
    return () => observer.disconnect();
  }, []);

  const valueAt = (signal: number): number | null => {
    const { curves } = props.moment ?? {};
    const place = curves?.times.findIndex((time) => time * kUs >= props.at_us) ?? -1;
    return place < 0 ? null : (curves?.max[signal]?.[place] ?? null);
  };
  return (
    <div class="plot">
      <div class="toolbar">
        <button type="button" disabled={props.whole} onClick={props.onWhole}>
          {word('boxWhole')}
        </button>
        <span class="hint">{word('boxPlotHint')}</span>
      </div>
      <div class="chart" ref={box} />
      <table class="legend">
        <tbody>
          {props.signals.map((name, i) => (
            <tr key={name}>
              <td>
                <span class="swatch" style={{ background: colourOf(i) }} />
                {name}
              </td>
              <td class="number">{`${number(valueAt(i), 2)} ${unitOf(name)}`}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
