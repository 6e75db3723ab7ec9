import uPlot from 'uplot';

import { type Curve, drawCurves } from './curves';

// Okabe and Ito's colours, which colour-blind people tell apart; the line's pattern differs as well.
const kColours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#56b4e9', '#e69f00', '#7f7f7f', '#b58900'];
const kDashes = [[], [8, 4], [2, 3], [10, 3, 2, 3]];

export function colourOf(i: number): string {
  return kColours[i % kColours.length] ?? '#0072b2';
}

export function dashOf(i: number): number[] {
  return kDashes[Math.floor(i / kColours.length) % kDashes.length] ?? [];
}

// Range of an axis without values.
const kUnknown: uPlot.Range.MinMax = [0, 1];
function isEmpty(min: number | null, max: number | null): boolean {
  return min === null || max === null || !Number.isFinite(min) || !Number.isFinite(max);
}

/** Range of an axis: from the least value to the greatest, with some room. */
export function around(_u: uPlot, min: number | null, max: number | null): uPlot.Range.MinMax {
  if (min === null || max === null || isEmpty(min, max)) return kUnknown;
  // A constant lies in the middle, a zero too.
  if (min === max) return [min - Math.max(1, Math.abs(min) / 10), max + Math.max(1, Math.abs(max) / 10)];
  return uPlot.rangeNum(min, max, 0.1, true);
}

export interface Kept {
  name: string;
  times: number[];
  values: (number | null)[];
}

export interface Mark {
  time: number;
  colour: string;
  text: string;
}

export interface ChartHooks {
  /** Time at which somebody clicked. */
  onClick: (time: number) => void;
  /** Times between which somebody dragged. */
  onSelect: (from: number, to: number) => void;
  marks: () => Mark[];
  kept: () => Kept[];
  /** Unit of a signal: those of one share an axis. */
  unit: (signal: string) => string;
}

// As seen from the newest value.
function secondsBefore(end: number, time: number): string {
  const seconds = time - end;
  const digits = Math.abs(seconds) < 2 ? 2 : 1;
  return `${seconds.toFixed(digits).replace('-', '−')} s`;
}

export function inkOf(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** Least and greatest values of each signal as a line with its band; an axis for each unit. */
export function makeChart(target: HTMLElement, signals: string[], hooks: ChartHooks): uPlot {
  const units = [...new Set(signals.map(hooks.unit))];
  const series: uPlot.Series[] = [{}];
  signals.forEach((signal) => {
    // Their curves are drawn by curves.ts.
    const look = { scale: hooks.unit(signal), paths: () => null, points: { show: false } };
    series.push({ ...look, label: `${signal} min` }, { ...look, label: signal });
  });
  const curves = (u: uPlot): Curve[] =>
    signals.map((signal, i) => ({
      low: u.data[2 * i + 1] ?? [],
      high: u.data[2 * i + 2] ?? [],
      scale: hooks.unit(signal),
      colour: colourOf(i),
      band: `${colourOf(i)}55`,
      dash: dashOf(i).map((length) => length * devicePixelRatio),
      width: 1.5 * devicePixelRatio,
    }));
  const scales: uPlot.Scales = {
    x: { time: false, range: (_u, min, max) => (isEmpty(min, max) ? kUnknown : min === max ? [min, min + 1] : [min, max]) },
  };
  for (const unit of units) scales[unit] = { range: around };
  const axis = { stroke: () => inkOf('--ink'), grid: { stroke: () => inkOf('--grid'), width: 1 }, ticks: { stroke: () => inkOf('--grid') } };
  const axes: uPlot.Axis[] = [
    { ...axis, values: (u, values) => values.map((v) => secondsBefore(u.scales['x']?.max ?? 0, v)) },
    ...units.map((unit, i) => ({
      ...axis,
      scale: unit,
      side: i % 2 === 0 ? 3 : 1,
      size: 64,
      label: unit === '' ? '' : unit,
      grid: { ...axis.grid, show: i === 0 },
    })),
  ];
  const chart = new uPlot(
    {
      width: Math.max(280, target.clientWidth),
      height: Math.max(240, target.clientHeight),
      series,
      scales,
      axes,
      legend: { show: false },
      cursor: { drag: { x: true, y: false, setScale: false }, points: { show: false } },
      hooks: {
        setSelect: [
          (u) => {
            if (u.select.width < 8) return;
            hooks.onSelect(u.posToVal(u.select.left, 'x'), u.posToVal(u.select.left + u.select.width, 'x'));
            u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          },
        ],
        drawAxes: [(u) => drawKept(u, hooks.kept(), hooks.unit)],
        draw: [(u) => clipped(u, () => drawCurves(u, curves(u))), (u) => drawMarks(u, hooks.marks())],
      },
    },
    [[], ...signals.flatMap(() => [[], []])] as unknown as uPlot.AlignedData,
    target,
  );
  let pressed = 0;
  chart.over.addEventListener('pointerdown', (event) => (pressed = event.clientX));
  chart.over.addEventListener('click', (event) => {
    if (Math.abs(event.clientX - pressed) < 4)
      hooks.onClick(chart.posToVal(event.clientX - chart.over.getBoundingClientRect().left, 'x'));
  });
  return chart;
}

export function clipped(u: uPlot, draw: (context: CanvasRenderingContext2D) => void): void {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  draw(ctx);
  ctx.restore();
}

// The curve of before behind today's, ending where the picture ends.
function drawKept(u: uPlot, kept: Kept[], unit: (signal: string) => string): void {
  const end = u.scales['x']?.max;
  if (end === undefined || end === null || kept.length === 0) return;
  const colour = inkOf('--kept');
  clipped(u, () => {
    for (const trace of kept) {
      const last = trace.times[trace.times.length - 1] ?? 0;
      const look = { scale: unit(trace.name), colour, band: colour, dash: [], width: 2 * devicePixelRatio };
      drawCurves(u, [{ ...look, low: trace.values, high: trace.values }], trace.times, end - last);
    }
  });
}

function drawMarks(u: uPlot, marks: Mark[]): void {
  clipped(u, (context) => {
    context.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    let free = -Infinity;
    for (const mark of [...marks].sort((a, b) => a.time - b.time)) {
      const x = Math.round(u.valToPos(mark.time, 'x', true));
      if (x < u.bbox.left || x > u.bbox.left + u.bbox.width) continue;
      context.strokeStyle = context.fillStyle = mark.colour;
      context.lineWidth = devicePixelRatio;
      context.setLineDash([4 * devicePixelRatio, 3 * devicePixelRatio]);
      context.beginPath();
      context.moveTo(x, u.bbox.top);
      context.lineTo(x, u.bbox.top + u.bbox.height);
      context.stroke();
      // Words that would lie over others are left out; the events are in their list.
      if (x < free) continue;
      context.fillText(mark.text, x + 3 * devicePixelRatio, u.bbox.top + 12 * devicePixelRatio);
      free = x + context.measureText(mark.text).width + 8 * devicePixelRatio;
    }
  });
}
