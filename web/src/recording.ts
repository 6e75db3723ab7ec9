// A recording of rc10d out of a file of anybody: every length is checked before it counts, and what is whole is shown.

import { type Field, type RecordingFormat, type Structure, numberAt, textAt } from './recording_format';
import { sortByTime } from './record_order';

/** The file as a whole is none that can be read. */
export interface Refusal {
  why: 'empty' | 'no_recording' | 'version' | 'too_large' | 'too_short' | 'header';
  /** A place in `header`: the field, its value and the largest that is possible. */
  field?: string;
  found?: number;
  most?: number;
}

/** A part that is missing or cannot be read. */
export interface Damage {
  what: 'cut' | 'positions' | 'broken' | 'too_many';
  /** Byte of the file at which it begins. */
  at: number;
  bytes: number;
  /** µs after the first record, of the last record before it; null: none. */
  after_us: number | null;
}

export interface Named {
  name: string;
}
export interface MotorEntry extends Named {
  model: string;
  bus: number;
}
export interface ModuleEntry extends Named {
  inputs: string[];
  events: string[];
}

export interface Header {
  robot: string;
  version: string;
  config_hash: string;
  cause: string;
  pid: number;
  rate_hz: number;
  ended: boolean;
  dropped: number;
  buses: (Named & { interface: string })[];
  motors: MotorEntry[];
  modules: ModuleEntry[];
}

/** One record with all its numbers by their names in src/blackbox/format.hpp. */
export interface Entry {
  kind: string;
  time_us: number;
  source: number;
  flags: number;
  id: number;
  numbers: Record<string, number>;
  texts: Record<string, string>;
  /** Payload of a frame, values of inputs, motors of a request. */
  list: number[];
}

export class RecordingError extends Error {
  constructor(readonly refusal: Refusal) {
    super(refusal.why);
  }
}

// A phone has no room for more; 256 MiB of frames of 8 bytes are 11 million.
const kMostRecords = 12_000_000;
const kMostDamages = 20;
// Times of records lie between a day before the start of the recording and three years after it.
const kEarliest_ns = -86_400e9;
const kLatest_ns = 3 * 366 * 86_400e9;
// So many records in a row, each where the one before ends, are no accident.
const kChain = 8;
const kRecordHeaderBytes = 16;
// Four buses at their full load receive some hundred frames in the longest tick.
const kMostFramesOfATick = 4096;
/** Moments that are no farther apart are one: a page calculates with fractions. */
export const kSame_us = 0.5;

interface Piece {
  stream: number;
  file: number;
  bytes: number;
}

/** Consecutive bytes of the stream; `synced`: a record begins there; `cut`: the file ends in it. */
interface Run {
  from: number;
  to: number;
  synced: boolean;
  cut: boolean;
}

export class Recording {
  readonly header: Header;
  readonly damages: Damage[] = [];
  /** All damages, also those that are not listed. */
  damageCount = 0;
  /** Times of all records, in order: µs since the first of them. */
  times: Float64Array;
  /** CLOCK_MONOTONIC of the first record, in ns. */
  first_ns = 0;

  private readonly format: RecordingFormat;
  private readonly wallOffset_us: number;
  private readonly start_ns: number;
  private stream = new Uint8Array(0);
  private view = new DataView(this.stream.buffer);
  private pieces: Piece[] = [];
  private offsets: Uint32Array;
  private readonly lists = new Map<number, Uint32Array>();
  private readonly most: number[];

  constructor(format: RecordingFormat, file: Uint8Array) {
    this.format = format;
    this.most = format.kinds.map((kind) => (kind === '' ? 0 : this.structure(kind).bytes));
    const head = new DataView(file.buffer, file.byteOffset, Math.min(file.byteLength, format.head_bytes));
    const sizes = checkedSizes(format, file, head);
    this.header = readHeader(format, file, head);
    this.start_ns = headerNumber(format, head, 'start_mono_ns');
    this.wallOffset_us = controlNumber(format, head, 'wall_offset_ns') / 1000;
    const runs = this.takeStream(file, head, sizes);
    const found = this.walk(runs);
    this.offsets = found.offsets;
    const times_ns = found.times;
    sortByTime(times_ns, this.offsets);
    this.first_ns = times_ns[0] ?? 0;
    this.times = times_ns;
    for (let i = 0; i < times_ns.length; ++i) this.times[i] = ((times_ns[i] ?? 0) - this.first_ns) / 1000;
    for (const damage of this.damages)
      if (damage.after_us !== null) damage.after_us = (damage.after_us - this.first_ns) / 1000;
    this.makeLists();
  }

  get size(): number {
    return this.offsets.length;
  }

  get last_us(): number {
    return this.times[this.times.length - 1] ?? 0;
  }

  /** Microseconds since 1970 of a moment of the recording. */
  wall_us(time_us: number): number {
    return this.first_ns / 1000 + time_us + this.wallOffset_us;
  }

  /** Records of a kind in the order of time; of one source, where each source has its own state. */
  of(kind: string, source?: number): Uint32Array {
    return this.lists.get(this.format.kinds.indexOf(kind) * 256 + (source ?? 255)) ?? kNone;
  }

  structure(kind: string): Structure {
    const found = this.format.structures[kind];
    if (found === undefined) throw new Error(`no structure ${kind}`);
    return found;
  }

  /** Number of a record; 0: the record is too short to have it. */
  number(index: number, field: Field, i = 0): number {
    const at = this.offsets[index] ?? 0;
    const end = field.at + (i + 1) * field.bytes;
    if (end > this.bytesAt(at)) return 0;
    return numberAt(this.view, at + field.at + i * field.bytes, field.type);
  }

  flags(index: number): number {
    return this.view.getUint8((this.offsets[index] ?? 0) + 3);
  }

  source(index: number): number {
    return this.view.getUint8((this.offsets[index] ?? 0) + 2);
  }

  id(index: number): number {
    return this.view.getUint32((this.offsets[index] ?? 0) + 4, true);
  }

  at(index: number): Entry {
    const at = this.offsets[index] ?? 0;
    const kind = this.format.kinds[this.view.getUint8(at)] ?? '';
    const entry: Entry = {
      kind,
      time_us: this.times[index] ?? 0,
      source: this.source(index),
      flags: this.flags(index),
      id: this.id(index),
      numbers: {},
      texts: {},
      list: [],
    };
    for (const [name, field] of Object.entries(this.structure(kind).fields)) {
      if (field.type === 'text')
        entry.texts[name] = field.at + field.bytes > this.bytesAt(at) ? '' : textAt(this.stream, at + field.at, field.bytes);
      else if (field.count === 1) entry.numbers[name] = this.number(index, field);
      else if (kind !== 'order') entry.list = this.listOf(index, kind, field);
      else entry.list = this.motorsOf(index, field);
    }
    return entry;
  }

  /** Index in `list` after the last record that is not later than `time_us`, as far as kSame_us tells. */
  until(list: Uint32Array, time_us: number): number {
    let low = 0;
    let high = list.length;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if ((this.times[list[middle] ?? 0] ?? 0) <= time_us + kSame_us) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** The moment of the tick before (`way` -1) or after one (1); null: none near it. Received frames have the kernel's time, all else its tick's. */
  nextTick(time_us: number, way: 1 | -1): number | null {
    let at = this.place(way === 1 ? time_us + kSame_us : time_us - kSame_us) - (way === 1 ? 0 : 1);
    for (let looked = 0; looked < kMostFramesOfATick && at >= 0 && at < this.size; ++looked, at += way) {
      const received = this.kindOf(at) === 'frame' && (this.flags(at) & this.format.flags.sent) === 0;
      if (!received) return this.times[at] ?? null;
    }
    return null;
  }

  motorName(index: number): string {
    return this.header.motors[index]?.name ?? '?';
  }

  busName(index: number): string {
    return this.header.buses[index]?.name ?? '?';
  }

  moduleName(index: number): string {
    return this.header.modules[index]?.name ?? '?';
  }

  /** Whose event it is: of a motor, a module, a bus or the robot. */
  sourceName(event: Entry): string {
    const { events, no_source } = this.format;
    if (event.source === no_source) return 'robot';
    if (event.id >= events.first_module && event.id <= events.last_module) return this.moduleName(event.source);
    return event.id >= events.first_bus ? this.busName(event.source) : this.motorName(event.source);
  }

  /** The module's own words for its event; "": others. */
  ownWords(event: Entry): string {
    if (event.id !== this.format.events.own_words) return '';
    return this.header.modules[event.source]?.events[event.numbers['value'] ?? -1] ?? '';
  }

  private kindOf(index: number): string {
    return this.format.kinds[this.view.getUint8(this.offsets[index] ?? 0)] ?? '';
  }

  // Number of records that are not later.
  private place(time_us: number): number {
    let low = 0;
    let high = this.size;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if ((this.times[middle] ?? 0) <= time_us) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  private bytesAt(at: number): number {
    return this.view.getUint8(at + 1) * this.format.word;
  }

  private listOf(index: number, kind: string, field: Field): number[] {
    const count = kind === 'frame' ? this.payloadOf(this.flags(index)) : Math.min(field.count, bitCount(this.id(index)));
    return Array.from({ length: count }, (_, i) => this.number(index, field, i));
  }

  private motorsOf(index: number, field: Field): number[] {
    const at = this.offsets[index] ?? 0;
    const motors: number[] = [];
    for (let i = 0; i < this.header.motors.length; ++i) {
      const place = field.at + (i >>> 3);
      if (place < this.bytesAt(at) && ((this.view.getUint8(at + place) >>> (i & 7)) & 1) === 1) motors.push(i);
    }
    return motors;
  }

  private payloadOf(flags: number): number {
    const bytes = this.format.payload_bytes[flags & 15] ?? 0;
    return (flags & this.format.flags.fd) !== 0 ? bytes : Math.min(bytes, 8);
  }

  // All of [oldest, head) that the file has, in order.
  private takeStream(file: Uint8Array, head: DataView, sizes: Sizes): Run[] {
    const control = (name: string) => controlNumber(this.format, head, name);
    const [begin, tail, end] = [control('oldest'), control('tail'), control('head')];
    // Both rings begin with a record, whatever is missing before them. Positions beyond the exact numbers would
    // never be passed.
    const parts: { offset: number; size: number; from: number; to: number; synced: boolean }[] = [];
    const history = { offset: sizes.historyOffset, size: sizes.historyBytes };
    const ring = { offset: sizes.ringOffset, size: sizes.ringBytes };
    const fits =
      Number.isSafeInteger(end) &&
      tail <= end && end - tail <= ring.size && begin <= end && (begin >= tail || tail - begin <= history.size);
    if (fits) {
      if (begin < tail) parts.push({ ...history, from: begin, to: tail, synced: true });
      parts.push({ ...ring, from: Math.max(begin, tail), to: end, synced: true });
    } else {
      this.damaged({ what: 'positions', at: this.format.control_at, bytes: 0, after_us: null });
      parts.push({ ...history, from: 0, to: history.size, synced: false });
    }
    if (file.byteLength < sizes.fileBytes)
      this.damaged({ what: 'cut', at: file.byteLength, bytes: sizes.fileBytes - file.byteLength, after_us: null });

    const runs: Run[] = [];
    let bytes = 0;
    let open = false;
    for (const part of parts) {
      let synced = part.synced;
      for (let from = part.from; from < part.to; ) {
        const place = from % part.size;
        const length = Math.min(part.to - from, part.size - place);
        const there = Math.min(length, Math.max(0, file.byteLength - part.offset - place));
        const last = runs[runs.length - 1];
        if (there > 0) {
          this.pieces.push({ stream: bytes, file: part.offset + place, bytes: there });
          if (open && last !== undefined) last.to += there;
          else runs.push({ from: bytes, to: bytes + there, synced, cut: false });
          bytes += there;
        }
        open = there === length;
        const newest = runs[runs.length - 1];
        if (!open && there > 0 && newest !== undefined) newest.cut = true;
        synced = open && synced;
        from += length;
      }
    }
    this.stream = new Uint8Array(bytes);
    this.view = new DataView(this.stream.buffer);
    for (const piece of this.pieces) this.stream.set(file.subarray(piece.file, piece.file + piece.bytes), piece.stream);
    return runs;
  }

  private walk(runs: Run[]): { times: Float64Array; offsets: Uint32Array } {
    let times = new Float64Array(1024);
    let offsets = new Uint32Array(1024);
    let count = 0;
    const breaks = (at: number, bytes: number) =>
      this.damaged({ what: 'broken', at: this.fileAt(at), bytes, after_us: count === 0 ? null : (times[count - 1] ?? 0) });
    for (const run of runs) {
      let at = run.synced ? run.from : this.findRecord(run.from, run.to);
      while (at < run.to) {
        const left = run.to - at;
        const bytes = left < kRecordHeaderBytes ? 0 : this.bytesAt(at);
        const kind = this.view.getUint8(at);
        if (run.cut && (left < kRecordHeaderBytes || (bytes > left && bytes <= (this.most[kind] ?? 0)))) break;
        if (bytes < kRecordHeaderBytes || bytes > left || !this.isInTime(at)) {
          const next = this.findRecord(at + this.format.word, run.to);
          breaks(at, next - at);
          at = next;
          continue;
        }
        if ((this.format.kinds[kind] ?? '') !== '') {
          if (count === kMostRecords) {
            this.damaged({ what: 'too_many', at: this.fileAt(at), bytes: left, after_us: times[count - 1] ?? 0 });
            return { times: times.slice(0, count), offsets: offsets.slice(0, count) };
          }
          if (count === times.length) {
            times = grown(times, new Float64Array(2 * count));
            offsets = grown(offsets, new Uint32Array(2 * count));
          }
          times[count] = this.timeAt(at);
          offsets[count++] = at;
        }
        at += bytes;
      }
    }
    return { times: times.slice(0, count), offsets: offsets.slice(0, count) };
  }

  // First place from `at` on where records follow one another; `end`: none.
  private findRecord(at: number, end: number): number {
    for (let from = at; from < end; from += this.format.word) {
      let next = from;
      let records = 0;
      while (records < kChain && end - next >= kRecordHeaderBytes) {
        const bytes = this.bytesAt(next);
        const most = this.most[this.view.getUint8(next)] ?? 0;
        if (bytes < kRecordHeaderBytes || bytes > most || bytes > end - next || !this.isInTime(next)) break;
        next += bytes;
        ++records;
      }
      if (records === kChain || (records > 0 && next === end)) return from;
    }
    return end;
  }

  private timeAt(at: number): number {
    return numberAt(this.view, at + 8, 'i64');
  }

  private isInTime(at: number): boolean {
    const since = this.timeAt(at) - this.start_ns;
    return since >= kEarliest_ns && since <= kLatest_ns;
  }

  private fileAt(at: number): number {
    const piece = this.pieces.findLast((each) => each.stream <= at);
    return piece === undefined ? 0 : piece.file + at - piece.stream;
  }

  private damaged(damage: Damage): void {
    ++this.damageCount;
    if (this.damages.length < kMostDamages) this.damages.push(damage);
  }

  private makeLists(): void {
    const own = new Set(['motor', 'bus', 'signals']);
    const keyOf = (index: number): number => {
      const type = this.view.getUint8(this.offsets[index] ?? 0);
      return type * 256 + (own.has(this.format.kinds[type] ?? '') ? this.source(index) : 255);
    };
    const counts = new Map<number, number>();
    for (let i = 0; i < this.size; ++i) {
      const key = keyOf(i);
      counts.set(key, (counts.get(key) ?? 0) + 1);
    }
    for (const [key, count] of counts) this.lists.set(key, new Uint32Array(count));
    counts.clear();
    for (let i = 0; i < this.size; ++i) {
      const key = keyOf(i);
      const place = counts.get(key) ?? 0;
      const list = this.lists.get(key);
      if (list !== undefined) list[place] = i;
      counts.set(key, place + 1);
    }
  }
}

const kNone = new Uint32Array(0);

function grown<T extends Float64Array | Uint32Array>(from: T, to: T): T {
  to.set(from);
  return to;
}

function bitCount(bits: number): number {
  let count = 0;
  for (let rest = bits >>> 0; rest !== 0; rest >>>= 1) count += rest & 1;
  return count;
}

interface Sizes {
  fileBytes: number;
  ringOffset: number;
  ringBytes: number;
  historyOffset: number;
  historyBytes: number;
}

function fieldOf(format: RecordingFormat, structure: string, name: string): Field {
  const field = format.structures[structure]?.fields[name];
  if (field === undefined) throw new Error(`no field ${structure}.${name}`);
  return field;
}

function headerNumber(format: RecordingFormat, head: DataView, name: string): number {
  const field = fieldOf(format, 'header', name);
  return numberAt(head, field.at, field.type);
}

function controlNumber(format: RecordingFormat, head: DataView, name: string): number {
  const field = fieldOf(format, 'control', name);
  return numberAt(head, format.control_at + field.at, field.type);
}

/** Sizes of the header that fit one another, or a RecordingError. */
function checkedSizes(format: RecordingFormat, file: Uint8Array, head: DataView): Sizes {
  const refuse = (refusal: Refusal): never => {
    throw new RecordingError(refusal);
  };
  if (file.byteLength === 0) refuse({ why: 'empty' });
  if (textAt(file, 0, format.magic.length) !== format.magic) refuse({ why: 'no_recording' });
  if (file.byteLength > format.max_file_bytes) refuse({ why: 'too_large', found: file.byteLength, most: format.max_file_bytes });
  const versionField = fieldOf(format, 'header', 'version');
  if (file.byteLength < versionField.at + versionField.bytes) refuse({ why: 'too_short', found: file.byteLength, most: format.head_bytes });
  const version = headerNumber(format, head, 'version');
  if (version !== format.version) refuse({ why: 'version', found: version, most: format.version });
  if (file.byteLength < format.head_bytes) refuse({ why: 'too_short', found: file.byteLength, most: format.head_bytes });
  const number = (name: string) => headerNumber(format, head, name);
  const among = (name: string, least: number, most: number): number => {
    const found = number(name);
    if (!(found >= least && found <= most)) refuse({ why: 'header', field: name, found, most });
    return found;
  };
  const fileBytes = among('file_bytes', format.head_bytes, format.max_file_bytes);
  const ringOffset = among('ring_offset', format.head_bytes, fileBytes);
  const ringBytes = among('ring_bytes', format.word, fileBytes - ringOffset);
  if (2 ** Math.round(Math.log2(ringBytes)) !== ringBytes) refuse({ why: 'header', field: 'ring_bytes', found: ringBytes, most: fileBytes });
  const historyOffset = among('history_offset', ringOffset + ringBytes, ringOffset + ringBytes);
  const historyBytes = among('history_bytes', fileBytes - historyOffset, fileBytes - historyOffset);
  if (historyBytes === 0) refuse({ why: 'header', field: 'history_bytes', found: 0, most: fileBytes });
  among('bus_count', 0, format.tables.buses.count);
  among('motor_count', 0, format.tables.motors.count);
  among('module_count', 0, format.tables.modules.count);
  return { fileBytes, ringOffset, ringBytes, historyOffset, historyBytes };
}

// After checkedSizes(): the tables lie in the head.
function readHeader(format: RecordingFormat, file: Uint8Array, head: DataView): Header {
  const text = (name: string) => {
    const field = fieldOf(format, 'header', name);
    return textAt(file, field.at, field.bytes);
  };
  const rows = <T>(table: keyof RecordingFormat['tables'], structure: string, count: string, row: (at: number) => T): T[] => {
    const bytes = format.structures[structure]?.bytes ?? 0;
    return Array.from({ length: headerNumber(format, head, count) }, (_, i) => row(format.tables[table].at + i * bytes));
  };
  const textIn = (structure: string, name: string, at: number, i = 0) => {
    const field = fieldOf(format, structure, name);
    return textAt(file, at + field.at + i * field.bytes, field.bytes);
  };
  const numberIn = (structure: string, name: string, at: number) => {
    const field = fieldOf(format, structure, name);
    return numberAt(head, at + field.at, field.type);
  };
  const textsIn = (name: string, count: string, at: number) => {
    const field = fieldOf(format, 'module_info', name);
    const length = Math.min(field.count, numberIn('module_info', count, at));
    return Array.from({ length }, (_, i) => textIn('module_info', name, at, i));
  };
  return {
    robot: text('robot'),
    version: text('program_version'),
    config_hash: text('config_hash'),
    cause: text('cause'),
    pid: headerNumber(format, head, 'pid'),
    rate_hz: headerNumber(format, head, 'rate_hz'),
    ended: controlNumber(format, head, 'ended') !== 0,
    dropped: controlNumber(format, head, 'dropped'),
    buses: rows('buses', 'bus_info', 'bus_count', (at) => ({
      name: textIn('bus_info', 'name', at),
      interface: textIn('bus_info', 'interface', at),
    })),
    motors: rows('motors', 'motor_info', 'motor_count', (at) => ({
      name: textIn('motor_info', 'name', at),
      model: textIn('motor_info', 'model', at),
      bus: numberIn('motor_info', 'bus', at),
    })),
    modules: rows('modules', 'module_info', 'module_count', (at) => ({
      name: textIn('module_info', 'name', at),
      inputs: textsIn('inputs', 'input_count', at),
      events: textsIn('events', 'event_count', at),
    })),
  };
}
