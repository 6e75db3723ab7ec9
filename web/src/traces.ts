import type { Columns } from './protocol';

/** Values that are drawn: columns of one view, oldest first, joined as they arrive. */
export class Traces {
  /** Time of each column in s, beginning at the first row ever seen. */
  times: number[] = [];
  min: (number | null)[][] = [];
  max: (number | null)[][] = [];
  private columnUs = 0;
  private end = 0;

  constructor(private readonly originUs: () => number) {}

  /** False: these columns belong to another view. */
  add(columns: Columns, view: number, keepColumns: number): boolean {
    if (columns.view !== view || columns.kind === 'range') return false;
    if (columns.kind === 'reset' || columns.columnUs !== this.columnUs) {
      this.times = [];
      this.min = columns.min.map(() => []);
      this.max = columns.max.map(() => []);
      this.columnUs = columns.columnUs;
      this.end = columns.first;
    }
    // Columns in between were not sent in time: a gap, drawn as one.
    if (columns.first > this.end && this.times.length > 0) this.push(this.end, () => null, () => null);
    for (let i = 0; i < columns.count; ++i)
      this.push(
        columns.first + i,
        (signal) => valueOf(columns.min[signal]?.[i]),
        (signal) => valueOf(columns.max[signal]?.[i]),
      );
    this.end = columns.first + columns.count;
    const surplus = this.times.length - keepColumns;
    if (surplus > 0) {
      this.times.splice(0, surplus);
      for (const values of [...this.min, ...this.max]) values.splice(0, surplus);
    }
    return true;
  }

  private push(column: number, min: (i: number) => number | null, max: (i: number) => number | null): void {
    this.times.push((column * this.columnUs - this.originUs()) / 1e6);
    this.min.forEach((values, i) => values.push(min(i)));
    this.max.forEach((values, i) => values.push(max(i)));
  }
}

function valueOf(value: number | undefined): number | null {
  return value === undefined || Number.isNaN(value) ? null : value;
}
