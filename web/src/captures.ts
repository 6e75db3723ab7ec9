// Captures: every tick around a trigger, kept with what was in force. They outlive the robot, and one file holds them.

export interface Capture {
  id: string;
  name: string;
  /** Date and time, ISO 8601. */
  taken: string;
  robot: string;
  config_hash: string;
  /** In force when it was taken; empty: not told. */
  gains: Record<string, number>;
  signals: string[];
  units: string[];
  period_s: number;
  /** Time of the trigger after the first value. */
  pre_s: number;
  /** By signal and tick; null: not known. */
  values: (number | null)[][];
}

/** Measures of a step response; null: the capture has no step. */
export interface StepNumbers {
  from: number;
  to: number;
  rise_s: number | null;
  overshoot: number | null;
  settling_s: number | null;
  error: number;
}

const kFormat = 'rc10 captures 1';
const kOtherFormat = /^\s*\{\s*"format"\s*:\s*"rc10 captures (?!1")/;
const kMostSamples = 20_000;
const kMostSignals = 32;
const kMostCaptures = 200;
/** Largest file that a page reads: meanwhile its STOP is not heard. */
export const kMostFileBytes = 64 * 1024 * 1024;
/** Tolerance of the settling time, as a share of the step. */
const kSettled = 0.05 + 1e-9;

// A capture does not change: another name is another object.
const texts = new WeakMap<Capture, string>();
function textOf(capture: Capture): string {
  const text = texts.get(capture) ?? JSON.stringify(capture);
  texts.set(capture, text);
  return text;
}

export function fileOf(captures: Capture[]): string {
  return `{"format":${JSON.stringify(kFormat)},"captures":[${captures.map(textOf).join(',')}]}`;
}

/** The newest of them whose file has at most so many characters. */
export function newestWithin(captures: Capture[], characters: number): Capture[] {
  let left = characters - fileOf([]).length;
  let first = captures.length;
  while (first > 0 && (left -= textOf(captures[first - 1] as Capture).length + 1) >= 0) --first;
  return captures.slice(first);
}

function isNumber(value: unknown): value is number {
  return typeof value === 'number' && Number.isFinite(value);
}

function isText(value: unknown, longest = 200): value is string {
  return typeof value === 'string' && value.length <= longest;
}

function textsOf(value: unknown): string[] | null {
  return Array.isArray(value) && value.length > 0 && value.length <= kMostSignals && value.every((each) => isText(each))
    ? (value as string[])
    : null;
}

/** A stranger's object; null: it is no capture. */
function captureOf(value: unknown): Capture | null {
  if (typeof value !== 'object' || value === null) return null;
  const { id, name, taken, robot, config_hash, gains, signals, units, period_s, pre_s, values } = value as Record<
    string,
    unknown
  >;
  const names = textsOf(signals);
  const known = textsOf(units);
  if (names === null || known === null || known.length !== names.length) return null;
  if (!isText(id) || !isText(name) || !isText(taken) || !isText(robot) || !isText(config_hash)) return null;
  if (!isNumber(period_s) || period_s <= 0 || !isNumber(pre_s)) return null;
  if (!Array.isArray(values) || values.length !== names.length) return null;
  const rows = values.map((row: unknown) =>
    Array.isArray(row) && row.length > 0 && row.length <= kMostSamples
      ? row.map((each: unknown) => (isNumber(each) ? each : null))
      : null,
  );
  const length = rows[0]?.length;
  if (rows.some((row) => row === null || row.length !== length)) return null;
  const told = typeof gains === 'object' && gains !== null ? Object.entries(gains) : [];
  return {
    id,
    name,
    taken,
    robot,
    config_hash,
    gains: Object.fromEntries(told.filter((entry): entry is [string, number] => isNumber(entry[1])).slice(0, 64)),
    signals: names,
    units: known,
    period_s,
    pre_s,
    values: rows as (number | null)[][],
  };
}

/** A file of captures that another version of the page has written. */
export function isOfOtherVersion(text: string): boolean {
  return kOtherFormat.test(text);
}

/** Captures of a file, each with an id of its own; null: it is none of these files. */
export function capturesIn(text: string): Capture[] | null {
  let file: unknown;
  try {
    file = JSON.parse(text);
  } catch {
    return null;
  }
  if (typeof file !== 'object' || file === null) return null;
  const { format, captures } = file as Record<string, unknown>;
  if (format !== kFormat || !Array.isArray(captures) || captures.length > kMostCaptures) return null;
  const found = captures.map(captureOf).filter((each) => each !== null);
  if (found.length < captures.length) return null;
  const ids = new Set<string>();
  return found.map((capture) => {
    let id = capture.id;
    for (let n = 2; ids.has(id); ++n) id = `${capture.id} ${n}`;
    ids.add(id);
    return id === capture.id ? capture : { ...capture, id };
  });
}

export function timesOf(capture: Capture): number[] {
  return (capture.values[0] ?? []).map((_, i) => i * capture.period_s - capture.pre_s);
}

/** Place of the response to the first signal: the next one of its unit. */
export function responseOf(capture: Capture): number {
  return capture.units.findIndex((unit, i) => i > 0 && unit === capture.units[0]);
}

/** Capture of the first signal as the target, and the next of its unit as the answer. */
export function stepNumbers(capture: Capture): StepNumbers | null {
  const answer = responseOf(capture);
  const target = capture.values[0] ?? [];
  const measured = capture.values[answer] ?? [];
  const to = target.findLast((value) => value !== null);
  // The target may have begun to ramp before the trigger: what comes well before it counts.
  const first = Math.floor(capture.pre_s / capture.period_s / 2);
  const before = measured.slice(0, first).filter((value) => value !== null);
  const from = before.length === 0 ? measured.find((value) => value !== null) : mean(before);
  if (answer < 0 || to === undefined || to === null || from === undefined || from === null) return null;
  const size = to - from;
  if (Math.abs(size) < 1e-9) return null;
  const share = measured.map((value) => (value === null ? null : (value - from) / size));
  const timeOf = (least: number) => {
    const at = share.findIndex((value, i) => i >= first && value !== null && value >= least);
    return at < 0 ? null : at * capture.period_s - capture.pre_s;
  };
  const low = timeOf(0.1);
  const high = timeOf(0.9);
  const highest = Math.max(...share.filter((value) => value !== null));
  const last = share.findLastIndex((value) => value !== null && Math.abs(value - 1) > kSettled);
  const settled = last >= share.length - 1 ? null : (last + 1) * capture.period_s - capture.pre_s;
  const end = measured.slice(-Math.max(1, Math.floor(measured.length / 10))).filter((value) => value !== null);
  return {
    from,
    to,
    rise_s: low === null || high === null ? null : high - low,
    overshoot: high === null ? null : Math.max(0, highest - 1),
    settling_s: settled === null ? null : Math.max(0, settled),
    error: end.length === 0 ? NaN : to - mean(end),
  };
}

function mean(values: number[]): number {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}
