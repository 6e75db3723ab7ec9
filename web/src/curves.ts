// Curves of a picture, one column of pixels at a time: so a fast signal costs what the picture is wide.

import type uPlot from 'uplot';

/** Values of a curve at the times of the picture; between the least and the greatest one lies its band. */
export interface Curve {
  low: ArrayLike<number | null | undefined>;
  high: ArrayLike<number | null | undefined>;
  scale: string;
  colour: string;
  /** Colour of the band. */
  band: string;
  dash: number[];
  width: number;
}

/** A curve in one column of pixels, from above; `joined`: the curve goes on from the column before. */
interface Column {
  x: number;
  top: number;
  bottom: number;
  joined: boolean;
}

// Steeper lines are rectangles: a rasteriser goes along each edge of a line, and along each of its dashes.
const kSteep = 4;
// Columns that are so far apart, in pixels, are few: all their lines are lines.
const kSparse = 3;

/** Least and greatest values of all times that lie in one column of pixels of [left, left + width]. */
export function pixelColumns(
  times: ArrayLike<number>,
  curve: Pick<Curve, 'low' | 'high'>,
  toX: (time: number) => number,
  toY: (value: number) => number,
  [left, right]: [number, number],
): Column[] {
  const columns: Column[] = [];
  let joined = false;
  // The first and the last one lie outside, so that the curve reaches both ends.
  const begin = Math.max(0, firstAt(times, (time) => toX(time) >= left) - 1);
  const end = Math.min(times.length, firstAt(times, (time) => toX(time) > right) + 1);
  for (let i = begin; i < end; ++i) {
    const [low, high] = [curve.low[i], curve.high[i]];
    if (low === null || low === undefined || high === null || high === undefined) {
      joined = false;
      continue;
    }
    const x = Math.floor(toX(times[i] ?? 0));
    const [top, bottom] = [toY(high), toY(low)];
    const last = columns[columns.length - 1];
    if (joined && last?.x === x) {
      last.top = Math.min(last.top, top);
      last.bottom = Math.max(last.bottom, bottom);
    } else columns.push({ x, top, bottom, joined });
    joined = true;
  }
  return columns;
}

/** `times`: those of the curves' values, and `later`, which is added to them. */
export function drawCurves(u: uPlot, curves: Curve[], times: ArrayLike<number> = u.data[0], later = 0): void {
  const { ctx, bbox } = u;
  const x = u.scales['x'];
  if (times.length === 0 || x?.min === undefined || x.max === undefined) return;
  const [from, perTime] = [x.min - later, bbox.width / (x.max - x.min)];
  for (const curve of curves) {
    const y = u.scales[curve.scale];
    if (y?.min === undefined || y.max === undefined) continue;
    const [greatest, perValue] = [y.max, bbox.height / (y.max - y.min)];
    const columns = pixelColumns(
      times,
      curve,
      (time) => bbox.left + (time - from) * perTime,
      (value) => bbox.top + (greatest - value) * perValue,
      [bbox.left, bbox.left + bbox.width],
    );
    ctx.fillStyle = curve.band;
    drawBand(ctx, columns, curve.width);
    ctx.fillStyle = ctx.strokeStyle = curve.colour;
    ctx.lineWidth = curve.width;
    ctx.lineJoin = 'round';
    ctx.setLineDash(curve.dash);
    drawLine(ctx, columns, (column) => column.top);
    if (curve.low !== curve.high) drawLine(ctx, columns, (column) => column.bottom);
  }
  ctx.setLineDash([]);
}

function drawBand(ctx: CanvasRenderingContext2D, columns: Column[], lineWidth: number): void {
  columns.forEach((column, i) => {
    const before = columns[i - 1];
    if (!column.joined || before === undefined) return;
    if (Math.max(column.bottom - column.top, before.bottom - before.top) <= lineWidth) return;
    if (column.x - before.x < kSparse) {
      ctx.fillRect(before.x, column.top, column.x - before.x, column.bottom - column.top);
      return;
    }
    ctx.beginPath();
    ctx.moveTo(before.x, before.top);
    ctx.lineTo(column.x, column.top);
    ctx.lineTo(column.x, column.bottom);
    ctx.lineTo(before.x, before.bottom);
    ctx.fill();
  });
}

function drawLine(ctx: CanvasRenderingContext2D, columns: Column[], edge: (column: Column) => number): void {
  const half = ctx.lineWidth / 2;
  ctx.beginPath();
  let down = false;
  columns.forEach((column, i) => {
    const before = columns[i - 1];
    const to = edge(column);
    if (!column.joined || before === undefined) {
      // One value alone between two gaps is a point.
      if (columns[i + 1]?.joined !== true) ctx.fillRect(column.x - half, to - half, 2 * half, 2 * half);
      down = false;
      return;
    }
    const [width, from] = [column.x - before.x, edge(before)];
    if (width < kSparse && Math.abs(to - from) > kSteep * width) {
      ctx.fillRect(column.x - half, Math.min(from, to) - half, 2 * half, Math.abs(to - from) + 2 * half);
      down = false;
      return;
    }
    if (!down) ctx.moveTo(before.x, from);
    ctx.lineTo(column.x, to);
    down = true;
  });
  ctx.stroke();
}

// Index of the first time of which this holds, as of all later ones.
function firstAt(times: ArrayLike<number>, holds: (time: number) => boolean): number {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (holds(times[middle] ?? 0)) high = middle;
    else low = middle + 1;
  }
  return low;
}
