// The moment of a recording that the page shows, and its surroundings.

import { type Entry, type Recording, kSame_us } from './recording';
import { type Field, type RecordingFormat, wordsOfBits } from './recording_format';

export interface Look {
  /** Picture: µs after the first record. */
  from_us: number;
  to_us: number;
  columns: number;
  signals: string[];
  at_us: number;
  /** Text that a frame's id or bus has; "": all frames. */
  filter: string;
  /** Warnings and errors alone. */
  problems: boolean;
}

export interface Curves {
  times: number[];
  min: (number | null)[][];
  max: (number | null)[][];
}

export interface MotorRow {
  name: string;
  model: string;
  status: string;
  acting: string;
  mode: string;
  unit: string;
  command_unit: string;
  stop_cause: string;
  zeroed: boolean;
  limits: string[];
  fault: number;
  fault_text: string;
  numbers: Record<string, number>;
}

export interface BusRow {
  name: string;
  state: string;
  numbers: Record<string, number>;
}

export interface ModuleRow {
  name: string;
  client: string;
  verdict: string;
  inputs: Record<string, number>;
}

export interface EventRow {
  time_us: number;
  severity: string;
  source: string;
  code: number;
  value: number;
  extra: number;
  client: string;
  /** Words of a module, its own; "": rc10-web has them. */
  text: string;
}

export interface FrameRow {
  time_us: number;
  bus: number;
  bus_name: string;
  sent: boolean;
  refused: boolean;
  error: boolean;
  /** As candump writes it. */
  text: string;
}

/** A command, an input or a request on its way to the scheduler. */
export interface OrderRow {
  time_us: number;
  who: string;
  what: string;
  verdict: string;
}

export interface Moment {
  /** The moment that was asked for. */
  at_us: number;
  curves: Curves;
  marks: { time_us: number; severity: string; source: string }[];
  wall_us: number;
  /** Number of the tick; null: not known. */
  tick: number | null;
  robot: { state: string; stop_cause: string; conditions: string[]; numbers: Record<string, number> } | null;
  motors: MotorRow[];
  buses: BusRow[];
  modules: ModuleRow[];
  events: EventRow[];
  frames: FrameRow[];
  orders: OrderRow[];
  /** Moments of the events before and after this one. */
  before_us: number | null;
  after_us: number | null;
  /** Moments of the ticks before and after this one. */
  tick_before_us: number | null;
  tick_after_us: number | null;
}

export interface Summary {
  robot: string;
  version: string;
  config_hash: string;
  pid: number;
  rate_hz: number;
  cause: string;
  ended: boolean;
  simulated: boolean;
  dropped: number;
  first_wall_us: number;
  last_us: number;
  /** Moment of the first tick that is known, within a tick; 0: none is. */
  phase_us: number;
  records: number;
  counts: Record<string, number>;
  /** Names of the signals of each motor, module and bus. */
  signals: { owner: string; names: string[] }[];
  /** Models of the drives of each bus. */
  models: string[][];
  damages: Recording['damages'];
  damageCount: number;
}

const kMostMarks = 200;
const kMostRows = 24;
// A filter that few frames pass is not searched through a whole large file at each step.
const kMostSearched = 400_000;
const kBusSignals = ['tec', 'rec', 'error_frames', 'tx_dropped'];
const kRecorded = ['frame', 'command', 'setpoint', 'signals', 'order', 'event', 'motor', 'robot', 'bus'];

function word(words: string[], index: number): string {
  return words[index] ?? 'unknown';
}

/** Fields of a motor that are a curve: those with a sign or a fraction. */
function readingsOf(format: RecordingFormat): string[] {
  return Object.entries(format.structures['motor']?.fields ?? {})
    .filter(([, field]) => field.type === 'f32' || field.type === 'f64' || field.type === 'i32')
    .map(([name]) => name);
}

export function summaryOf(recording: Recording, format: RecordingFormat): Summary {
  const { header } = recording;
  const readings = readingsOf(format);
  const counts: Record<string, number> = {};
  for (const kind of kRecorded) {
    const own = kind === 'motor' ? header.motors.length : kind === 'bus' ? header.buses.length : kind === 'signals' ? header.modules.length : 0;
    counts[kind] =
      own === 0 ? recording.of(kind).length : Array.from({ length: own }, (_, i) => recording.of(kind, i).length).reduce((a, b) => a + b, 0);
  }
  return {
    robot: header.robot,
    version: header.version,
    config_hash: header.config_hash,
    pid: header.pid,
    rate_hz: header.rate_hz,
    cause: header.cause,
    ended: header.ended,
    simulated: header.buses.some((bus) => bus.interface === ''),
    dropped: header.dropped,
    first_wall_us: recording.wall_us(0),
    last_us: recording.last_us,
    phase_us: (recording.times[recording.of('robot')[0] ?? -1] ?? 0) % (1e6 / (header.rate_hz > 0 ? header.rate_hz : 1000)),
    records: recording.size,
    counts,
    signals: [
      ...header.motors.map((motor) => ({ owner: motor.name, names: readings.map((name) => `${motor.name}.${name}`) })),
      ...header.modules.map((module) => ({ owner: module.name, names: module.inputs.map((name) => `${module.name}.${name}`) })),
      ...header.buses.map((bus) => ({ owner: bus.name, names: kBusSignals.map((name) => `${bus.name}.${name}`) })),
    ].filter((owner) => owner.names.length > 0),
    models: header.buses.map((_, bus) => [...new Set(header.motors.filter((motor) => motor.bus === bus).map((motor) => motor.model))]),
    damages: recording.damages,
    damageCount: recording.damageCount,
  };
}

interface Source {
  list: Uint32Array;
  value: (index: number) => number;
}

function sourceOf(recording: Recording, format: RecordingFormat, signal: string): Source | null {
  const { header } = recording;
  const dot = signal.indexOf('.');
  const [owner, name] = [signal.slice(0, dot), signal.slice(dot + 1)];
  const plain = (kind: string, source: number): Source | null => {
    const field = format.structures[kind]?.fields[name];
    return field === undefined ? null : { list: recording.of(kind, source), value: (index) => recording.number(index, field) };
  };
  const motor = header.motors.findIndex((each) => each.name === owner);
  if (motor >= 0) return plain('motor', motor);
  const module = header.modules.findIndex((each) => each.name === owner);
  const input = header.modules[module]?.inputs.indexOf(name) ?? -1;
  const values = format.structures['signals']?.fields['values'];
  if (input >= 0 && values !== undefined) return { list: recording.of('signals', module), value: (index) => inputOf(recording, index, input, values) };
  const bus = header.buses.findIndex((each) => each.name === owner);
  return bus >= 0 ? plain('bus', bus) : null;
}

// Values are there for the inputs whose bits are set, in their order.
function inputOf(recording: Recording, index: number, input: number, values: Field): number {
  const given = recording.id(index);
  if (((given >>> input) & 1) === 0) return NaN;
  let place = 0;
  for (let i = 0; i < input; ++i) place += (given >>> i) & 1;
  return recording.number(index, values, place);
}

/** Least and greatest value of each column; where nothing was recorded, the value of before still stands. */
export function curvesOf(recording: Recording, format: RecordingFormat, look: Look): Curves {
  const columns = Math.max(1, Math.min(4096, Math.floor(look.columns)));
  const width = Math.max(1e-3, look.to_us - look.from_us) / columns;
  const curves: Curves = { times: Array.from({ length: columns }, (_, i) => (look.from_us + (i + 1) * width) / 1e6), min: [], max: [] };
  for (const signal of look.signals) {
    const source = sourceOf(recording, format, signal);
    const min = new Array<number | null>(columns).fill(null);
    const max = new Array<number | null>(columns).fill(null);
    curves.min.push(min);
    curves.max.push(max);
    if (source === null) continue;
    const { list, value } = source;
    let next = recording.until(list, look.from_us);
    let last = next > 0 ? value(list[next - 1] ?? 0) : NaN;
    for (let column = 0; column < columns; ++column) {
      const end = look.from_us + (column + 1) * width;
      let least = last;
      let greatest = last;
      let any = false;
      for (; next < list.length && (recording.times[list[next] ?? 0] ?? 0) <= end; ++next) {
        last = value(list[next] ?? 0);
        if (Number.isNaN(last)) continue;
        least = any ? Math.min(least, last) : last;
        greatest = any ? Math.max(greatest, last) : last;
        any = true;
      }
      if (Number.isFinite(least)) min[column] = least;
      if (Number.isFinite(greatest)) max[column] = greatest;
    }
  }
  return curves;
}

function latest(recording: Recording, kind: string, source: number | undefined, at_us: number): Entry | null {
  const list = recording.of(kind, source);
  const count = recording.until(list, at_us);
  return count === 0 ? null : recording.at(list[count - 1] ?? 0);
}

function motorRow(recording: Recording, format: RecordingFormat, index: number, at_us: number): MotorRow {
  const { words } = format;
  const entry = latest(recording, 'motor', index, at_us);
  const motor = recording.header.motors[index];
  const id = entry?.id ?? 0;
  const fault = entry?.numbers['fault'] ?? 0;
  return {
    name: motor?.name ?? '?',
    model: motor?.model ?? '',
    status: entry === null ? '' : word(words.status, entry.flags),
    acting: entry === null ? '' : word(words.acting, id >>> 24),
    mode: word(words.mode, id & 0xff),
    unit: words.mode_unit[id & 0xff] ?? '',
    command_unit: words.command_unit[(id >>> 8) & 0xff] ?? '',
    stop_cause: word(words.stop_cause, entry?.numbers['stop_cause'] ?? 0),
    zeroed: ((id >>> 16) & 1) === 1,
    limits: wordsOfBits(words.limit, entry?.numbers['limits'] ?? 0),
    fault,
    fault_text: fault === 0 ? '' : (format.faults[fault] ?? `fault ${fault}`),
    numbers: entry?.numbers ?? {},
  };
}

export function eventRow(recording: Recording, format: RecordingFormat, index: number): EventRow {
  const event = recording.at(index);
  return {
    time_us: event.time_us,
    severity: word(format.words.severity, event.flags),
    source: recording.sourceName(event),
    // As rc10d counts them: with a sign.
    code: event.id | 0,
    value: event.numbers['value'] ?? 0,
    extra: event.numbers['extra'] ?? 0,
    client: event.texts['client'] ?? '',
    text: recording.ownWords(event),
  };
}

const kHex = Array.from({ length: 256 }, (_, i) => i.toString(16).toUpperCase().padStart(2, '0'));

function idText(format: RecordingFormat, id: number): string {
  const { error, extended } = format.ids;
  const mask = (id & error) !== 0 ? 0x1fffffff | error : (id & extended) !== 0 ? 0x1fffffff : 0x7ff;
  return ((id & mask) >>> 0).toString(16).toUpperCase().padStart(mask === 0x7ff ? 3 : 8, '0');
}

/** As `candump -L` writes it: "201#0011", "00000901##1AABB", "123#R". */
function frameText(format: RecordingFormat, id: number, flags: number, payload: number[]): string {
  const digits = idText(format, id);
  if ((id & format.ids.remote) !== 0) return `${digits}#R${payload.length === 0 ? '' : payload.length}`;
  const fd = (flags & format.flags.fd) !== 0;
  return `${digits}${fd ? `##${(flags & format.flags.bit_rate_switch) !== 0 ? 1 : 0}` : '#'}${payload.map((byte) => kHex[byte & 0xff] ?? '').join('')}`;
}

function frameRow(recording: Recording, format: RecordingFormat, index: number): FrameRow {
  const frame = recording.at(index);
  return {
    time_us: frame.time_us,
    bus: frame.source,
    bus_name: recording.busName(frame.source),
    sent: (frame.flags & format.flags.sent) !== 0,
    refused: (frame.flags & format.flags.refused) !== 0,
    error: (frame.id & format.ids.error) !== 0,
    text: frameText(format, frame.id, frame.flags, frame.list),
  };
}

// Rows around a moment: half of them before it, those of the same moment among them.
function around<T>(list: Uint32Array, middle: number, row: (index: number) => T | null): T[] {
  const before: T[] = [];
  for (let i = middle - 1; i >= Math.max(0, middle - kMostSearched) && before.length < kMostRows / 2; --i) {
    const found = row(list[i] ?? 0);
    if (found !== null) before.unshift(found);
  }
  const after: T[] = [];
  for (let i = middle; i < Math.min(list.length, middle + kMostSearched) && after.length < kMostRows / 2; ++i) {
    const found = row(list[i] ?? 0);
    if (found !== null) after.push(found);
  }
  return [...before, ...after];
}

function orderRow(recording: Recording, format: RecordingFormat, index: number): OrderRow {
  const entry = recording.at(index);
  const { words } = format;
  const who = entry.texts['client'] ?? '';
  const row = { time_us: entry.time_us, who, what: '', verdict: '' };
  if (entry.kind === 'setpoint') {
    row.what = `${recording.motorName(entry.source)} ${word(words.mode, entry.id)} ${Number((entry.numbers['value'] ?? 0).toPrecision(6))} ${words.mode_unit[entry.id] ?? ''}`.trim();
    row.verdict = (entry.flags & format.flags.setpoint_skipped) !== 0 ? 'skipped' : '';
  } else if (entry.kind === 'order') {
    row.what = `${word(words.operation, entry.flags)} ${entry.source !== 0 ? '' : entry.list.map((motor) => recording.motorName(motor)).join(', ')}`.trim();
  } else {
    row.what = `command (${entry.id})`;
    row.verdict = word(words.verdict, entry.flags);
  }
  return row;
}

// A command comes before its setpoints, of the same moment.
function ordersAround(recording: Recording, format: RecordingFormat, at_us: number): OrderRow[] {
  const rows = ['order', 'command', 'setpoint']
    .map((kind) => recording.of(kind))
    .flatMap((list) => around(list, recording.until(list, at_us), (index) => orderRow(recording, format, index)))
    .sort((a, b) => a.time_us - b.time_us);
  const here = rows.filter((row) => row.time_us <= at_us + kSame_us).length;
  return rows.slice(Math.max(0, here - kMostRows / 2), here + kMostRows / 2);
}

// Ticks count on from the robot's last record; where ticks were missed they are fewer, and the next record says so.
function tickAt(recording: Recording, at_us: number): number | null {
  const list = recording.of('robot');
  const count = recording.until(list, at_us);
  if (count === 0) return null;
  const { rate_hz } = recording.header;
  const before = recording.at(list[count - 1] ?? 0);
  const tick = (before.numbers['tick'] ?? 0) + Math.round(((at_us - before.time_us) * (rate_hz > 0 ? rate_hz : 1000)) / 1e6);
  const next = count < list.length ? recording.at(list[count] ?? 0).numbers['tick'] : undefined;
  return next === undefined ? tick : Math.min(tick, next - 1);
}

export function momentOf(recording: Recording, format: RecordingFormat, look: Look): Moment {
  const { header } = recording;
  const { words } = format;
  const at_us = look.at_us;
  const robot = latest(recording, 'robot', undefined, at_us);
  const events = recording.of('event');
  const counts = (index: number) => !look.problems || recording.flags(index) > 0;
  const here = recording.until(events, at_us);
  const earlier = events.subarray(0, here).findLast((index) => (recording.times[index] ?? 0) < at_us - kSame_us && counts(index));
  const later = events.subarray(here).find((index) => counts(index));
  const marked = events.subarray(recording.until(events, look.from_us), recording.until(events, look.to_us));
  const serious = Array.from(marked.filter((index) => recording.flags(index) > 0)).slice(-kMostMarks);
  const plain = look.problems ? [] : Array.from(marked.filter((index) => recording.flags(index) === 0)).slice(-(kMostMarks - serious.length + 1));
  const frames = recording.of('frame');
  const filter = look.filter.trim().toUpperCase();
  return {
    at_us,
    curves: curvesOf(recording, format, look),
    marks: [...plain, ...serious].map((index) => {
      const row = eventRow(recording, format, index);
      return { time_us: row.time_us, severity: row.severity, source: row.source };
    }),
    wall_us: recording.wall_us(at_us),
    tick: tickAt(recording, at_us),
    robot:
      robot === null
        ? null
        : {
            state: word(words.robot, robot.flags),
            stop_cause: word(words.stop_cause, robot.source),
            conditions: wordsOfBits(words.condition, robot.id),
            numbers: robot.numbers,
          },
    motors: header.motors.map((_, i) => motorRow(recording, format, i, at_us)),
    buses: header.buses.map((bus, i) => {
      const entry = latest(recording, 'bus', i, at_us);
      return { name: bus.name, state: entry === null ? '' : word(words.bus, entry.flags), numbers: entry?.numbers ?? {} };
    }),
    modules: header.modules.map((module, i) => {
      const list = recording.of('signals', i);
      const count = recording.until(list, at_us);
      const entry = count === 0 ? null : recording.at(list[count - 1] ?? 0);
      const inputs: Record<string, number> = {};
      let place = 0;
      module.inputs.forEach((name, input) => {
        if (entry !== null && ((entry.id >>> input) & 1) === 1) inputs[name] = entry.list[place++] ?? NaN;
      });
      return { name: module.name, client: entry?.texts['client'] ?? '', verdict: entry === null ? '' : word(words.verdict, entry.flags), inputs };
    }),
    events: around(events, here, (index) => (counts(index) ? eventRow(recording, format, index) : null)),
    frames: around(frames, recording.until(frames, at_us), (index) =>
      filter === '' ||
      idText(format, recording.id(index)).startsWith(filter) ||
      recording.busName(recording.source(index)).toUpperCase() === filter
        ? frameRow(recording, format, index)
        : null,
    ),
    orders: ordersAround(recording, format, at_us),
    before_us: earlier === undefined ? null : (recording.times[earlier] ?? null),
    after_us: later === undefined ? null : (recording.times[later] ?? null),
    tick_before_us: recording.nextTick(at_us, -1),
    tick_after_us: recording.nextTick(at_us, 1),
  };
}
