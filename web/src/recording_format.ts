// Layout and words of a recording, as rc10-web serves them: src/client/recording_format.hpp is their source.

export const kFormatPath = 'recording-format.json';

export interface Field {
  /** Bytes from the beginning of its structure. */
  at: number;
  type: 'u8' | 'u16' | 'u32' | 'u64' | 'i8' | 'i16' | 'i32' | 'i64' | 'f32' | 'f64' | 'text';
  /** Size of one element. */
  bytes: number;
  count: number;
}

export interface Structure {
  bytes: number;
  fields: Record<string, Field>;
}

export interface RecordingFormat {
  magic: string;
  version: number;
  word: number;
  max_file_bytes: number;
  head_bytes: number;
  control_at: number;
  /** Places of the tables in the header. */
  tables: Record<'buses' | 'motors' | 'modules', { at: number; count: number }>;
  structures: Record<string, Structure>;
  /** Structure of a record by its type; "": no such type. */
  kinds: string[];
  no_source: number;
  flags: Record<'fd' | 'bit_rate_switch' | 'sent' | 'refused' | 'setpoint_skipped', number>;
  ids: Record<'extended' | 'remote' | 'error', number>;
  /** Bytes by the length code. */
  payload_bytes: number[];
  events: Record<'own_words' | 'ticks_missed' | 'first_module' | 'last_module' | 'first_bus', number>;
  words: Record<
    | 'mode'
    | 'mode_unit'
    | 'status'
    | 'robot'
    | 'acting'
    | 'stop_cause'
    | 'condition'
    | 'bus'
    | 'command_unit'
    | 'limit'
    | 'severity'
    | 'verdict'
    | 'operation',
    string[]
  >;
  faults: Record<string, string>;
}

const kTwo32 = 4294967296;

/** Number at `at`; 64 bits are exact up to 2^53. */
export function numberAt(view: DataView, at: number, type: Field['type']): number {
  switch (type) {
    case 'u8':
      return view.getUint8(at);
    case 'i8':
      return view.getInt8(at);
    case 'u16':
      return view.getUint16(at, true);
    case 'i16':
      return view.getInt16(at, true);
    case 'u32':
      return view.getUint32(at, true);
    case 'i32':
      return view.getInt32(at, true);
    case 'u64':
      return view.getUint32(at + 4, true) * kTwo32 + view.getUint32(at, true);
    case 'i64':
      return view.getInt32(at + 4, true) * kTwo32 + view.getUint32(at, true);
    case 'f32':
      return view.getFloat32(at, true);
    case 'f64':
      return view.getFloat64(at, true);
    case 'text':
      return NaN;
  }
}

const kDecoder = new TextDecoder();

/** Text of fixed room, up to its first zero. */
export function textAt(bytes: Uint8Array, at: number, room: number): string {
  const all = bytes.subarray(at, at + room);
  const end = all.indexOf(0);
  return kDecoder.decode(end < 0 ? all : all.subarray(0, end));
}

/** Words of the bits that are set. */
export function wordsOfBits(words: string[], bits: number): string[] {
  return words.filter((_, i) => ((bits >>> i) & 1) === 1);
}
