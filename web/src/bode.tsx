// Frequency responses over one another: gain, phase, and the coherence that says how far to trust them.
import { useEffect, useRef } from 'preact/hooks';
import uPlot from 'uplot';

import { inkOf } from './chart';
import { useStudio } from './context';
import type { TestResult } from './motion_test';

const kRows = [
  { key: 'gain_db', unit: 'dB', word: 'bodeGain' },
  { key: 'phase_deg', unit: '°', word: 'bodePhase' },
  { key: 'coherence', unit: '', word: 'bodeCoherence' },
] as const;
const kHeight = 170;

export function Bode(props: { results: TestResult[]; colours: Map<string, string> }) {
  const { word } = useStudio();
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const target = box.current;
    if (target === null || props.results.length === 0) return;
    const width = () => Math.max(260, target.clientWidth);
    const axis = { stroke: inkOf('--ink'), grid: { stroke: inkOf('--grid'), width: 1 }, ticks: { stroke: inkOf('--grid') } };
    const charts = kRows.map((row) => {
      const tables = props.results.map(
        (result) => [result.report.response.map((point) => point.frequency_hz), result.report.response.map((point) => point[row.key])] as uPlot.AlignedData,
      );
      const chart = new uPlot(
        {
          width: width(),
          height: kHeight,
          scales: { x: { time: false, distr: 3 }, ...(row.key === 'coherence' ? { y: { range: [0, 1.05] } } : {}) },
          axes: [
            { ...axis, values: (_u, values) => values.map((value) => (value === null ? '' : `${value} Hz`)) },
            { ...axis, size: 64, label: `${word(row.word)}${row.unit === '' ? '' : ` ${row.unit}`}` },
          ],
          series: [
            {},
            ...props.results.map((result) => ({
              label: result.name,
              stroke: props.colours.get(result.id) ?? inkOf('--blue'),
              width: 2,
              spanGaps: true,
              points: { show: true, size: 4 },
            })),
          ],
          legend: { show: false },
        },
        uPlot.join(tables),
        target,
      );
      return chart;
    });
    const observer = new ResizeObserver(() => charts.forEach((chart) => chart.setSize({ width: width(), height: kHeight })));
    observer.observe(target);
    return () => {
      observer.disconnect();
      for (const chart of charts) chart.destroy();
    };
  }, [props.results, word]);
  return <div class="overlay bode" ref={box} role="img" aria-label={word('bode')} />;
}
