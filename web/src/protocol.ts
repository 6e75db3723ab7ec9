// Messages between rc10-web and this page; src/web/page_messages.hpp, frame_writer.hpp and columns_frame.hpp are their other end.

import type { TestReport } from './motion_test';

export const kProtocol = 3;

export type Right = 'nothing' | 'look' | 'command';

export interface Hello {
  type: 'hello';
  protocol: number;
  version: string;
  right: Right;
  name: string;
}

export interface Down {
  type: 'down';
  reason: string;
  /** Mistakes for which the last start was refused; empty: it was not. */
  refusal: string;
  /** Seconds since 1970. */
  refused_at: number;
  /** The last lines of the last run. */
  log: string;
  logged_at: number;
}

export interface MotorInfo {
  name: string;
  model: string;
  bus: string;
  id: number;
  modes: string[];
}

export interface ModuleInfo {
  name: string;
  type: string;
  inputs: string[];
  outputs: string[];
}

export interface Robot {
  type: 'robot';
  robot: {
    robot: string;
    version: string;
    config_hash: string;
    pid: number;
    rate_hz: number;
    motors: MotorInfo[];
  };
  modules: ModuleInfo[];
  readings: string[];
}

/** A motor as motor_state_t.lcm has it; null: not reported. */
export interface MotorState {
  name: string;
  status: 'OFFLINE' | 'READY' | 'ENABLING' | 'ACTIVE' | 'FAULT';
  fault: number;
  fault_text: string;
  limits: string[];
  mode: string;
  owner: string;
  zeroed: boolean;
  acting: 'nothing' | 'target' | 'hold' | 'damp' | 'brake' | 'ramp';
  stop_cause: string;
  stopped_by: string;
  target: number | null;
  target_shaped: number | null;
  feedback_hz: number | null;
  feedback_age_us: number;
  total_angle_deg: number | null;
  angle_deg: number | null;
  velocity_rpm: number | null;
  current_a: number | null;
  torque_nm: number | null;
  voltage_v: number | null;
  temperature_c: number | null;
}

export interface ModuleState {
  name: string;
  type: string;
  owner: string;
  inputs: string[];
  outputs: Record<string, number | null>;
}

export interface State {
  type: 'state';
  data: {
    /** Wall clock of rc10d at mono_us, µs since 1970. */
    utime: number;
    mono_us: number;
    state: 'RUN' | 'ESTOP' | 'STOPPING';
    realtime: boolean;
    stop_cause: string;
    stopped_by: string;
    stopped_mono_us: number;
    estop_count: number;
    conditions: string[];
    motors: MotorState[];
  };
  modules: { modules: ModuleState[] };
}

export interface Percentiles {
  p50: number;
  p99: number;
  p999: number;
  max: number;
}

export interface Bus {
  name: string;
  interface: string;
  state: string;
  predicted_load: number;
  predicted_load_worst: number;
  measured_load: number;
  rx_frames: number;
  tx_frames: number;
  rx_unmatched: number;
  rx_foreign: number;
  rx_dropped: number;
  tx_dropped: number;
  error_frames: number;
  restarts: number;
}

export interface Diagnostics {
  type: 'diagnostics';
  data: {
    tick_period_us: number;
    wake_latency_us: Percentiles;
    tick_duration_us: Percentiles;
    missed_ticks: number;
    page_faults: number;
    refusals: Record<string, number>;
    counters: Record<string, number>;
    durations_us: Record<string, Percentiles & { count: number }>;
    notices: string[];
    buses: Bus[];
  };
}

export interface RobotEvent {
  type: 'event';
  utime: number;
  mono_us: number;
  severity: 'info' | 'warning' | 'error';
  code: number;
  source: string;
  client: string;
  text: string;
}

export interface ViewAnswer {
  type: 'view';
  view: number;
  signals: string[];
  unknown: string[];
  dropped_ticks: number;
}

// Values with which what a request does ends with this page, however that ends: src/link/until_its_end.hpp.
export const kDisableAtEnd = { disable_at_end: 1 };
export const kRestoreAtEnd = { restore_at_end: 1 };
// Value of a disable that comes with an end: what an e-stop holds stays held (src/link/at_end.hpp).
export const kAtEnd = { at_end: 1 };

export interface Response {
  type: 'response';
  seq: number;
  status: 'ok' | 'refused' | 'failed';
  message: string;
  values: Record<string, number>;
  /** Sightings of a scan. */
  heard: Sighting[];
}

/** Frames under one id, and who may have sent them. */
export interface Sighting {
  frame_id: number;
  extended: boolean;
  frames: number;
  ambiguous: boolean;
  guesses: { kind: string; id: number; from_drive: boolean; motor: string | null; collides: boolean }[];
  advice: string | null;
}

/** A recording on the robot's computer. */
export interface RecordingFile {
  name: string;
  changed_us: number;
  live: boolean;
}

export interface Recordings {
  type: 'recordings';
  seq: number;
  recordings: RecordingFile[];
}

/** Words for the numbers of a recording, in the order of the question; "": not known. */
export interface RecordedWords {
  type: 'words';
  seq: number;
  events: string[];
  frames: string[];
}

/** The robot's file as rc10-web knows it. */
export interface ConfigFile {
  type: 'config';
  seq: number;
  of: 'running' | 'last' | 'refused';
  /** The whole text with its tokens. */
  sha256: string;
  /** `hidden`: tokens that are not shown; `why`: nothing is, and why. */
  config: { text: string; hidden: number; why: string };
}

export interface ConfigProblem {
  /** From 1; 0: of the file as a whole. */
  line: number;
  column: number;
  path: string;
  text: string;
}

export interface CheckedMotor {
  name: string;
  model: string;
  id: number;
  command: string;
  feedback: string;
  load: number;
  direction: number;
  gear_ratio: number;
  /** "at power-on", "at 0 deg" of an absolute encoder, "on request". */
  zero: string;
  on_timeout: string;
  on_disable: string;
  on_estop: string;
  /** Lines by which a loop acts after a target, a disable or an e-stop: not before the first spin has shown its sign. */
  untested_loops: string[];
}

export interface CheckedBus {
  name: string;
  /** "": simulated. */
  interface: string;
  bitrate: number;
  /** 0: a classic bus. */
  data_bitrate: number;
  load: number;
  load_worst: number;
  motors: CheckedMotor[];
}

export interface CheckedGroup {
  name: string;
  motors: string[];
  rearms_at_rest: boolean;
  together: boolean;
  implied: boolean;
}

/** Verdict of rc10d on a text. */
export interface CheckedConfig {
  type: 'config_checked';
  seq: number;
  checked: {
    errors: ConfigProblem[];
    warnings: ConfigProblem[];
    robot: { name: string; buses: CheckedBus[]; groups: CheckedGroup[]; report: string } | null;
  };
}

export interface TestGoesOn {
  type: 'test';
  seq: number;
  time_s: number;
  lasts_s: number;
}

export interface TestDone {
  type: 'test_done';
  seq: number;
  time_s: number;
  /** Behaviour of the motor now, in words. */
  doing: string;
  report: TestReport;
}

/** The answer to a beat of this page. */
interface Clock {
  type: 'clock';
}

export type ServerMessage =
  | ConfigFile
  | CheckedConfig
  | Hello
  | Down
  | Robot
  | State
  | Diagnostics
  | RobotEvent
  | ViewAnswer
  | Recordings
  | RecordedWords
  | TestGoesOn
  | TestDone
  | Clock
  | Response;

export type FrameKind = 'next' | 'reset' | 'range';

/** Least and greatest value of each column of some signals; NaN: none. */
export interface Columns {
  kind: FrameKind;
  view: number;
  first: number;
  columnUs: number;
  count: number;
  min: Float32Array[];
  max: Float32Array[];
}

const kHeaderBytes = 32;
const kKinds: Record<number, FrameKind> = { 1: 'next', 2: 'reset', 3: 'range' };

/** Null: another version, or too short. */
export function readColumns(buffer: ArrayBuffer): Columns | null {
  if (buffer.byteLength < kHeaderBytes) return null;
  const data = new DataView(buffer);
  const kind = kKinds[data.getUint8(1)];
  if (data.getUint8(0) !== 1 || kind === undefined) return null;
  const signals = data.getUint16(2, true);
  const count = data.getUint32(4, true);
  if (buffer.byteLength !== kHeaderBytes + signals * count * 8) return null;
  const min: Float32Array[] = [];
  const max: Float32Array[] = [];
  for (let i = 0; i < signals; ++i) {
    const at = kHeaderBytes + i * count * 8;
    min.push(new Float32Array(buffer, at, count));
    max.push(new Float32Array(buffer, at + count * 4, count));
  }
  return {
    kind,
    view: data.getUint32(8, true),
    first: data.getFloat64(16, true),
    columnUs: data.getFloat64(24, true),
    count,
    min,
    max,
  };
}

/** A piece of a recording; the one at 0 is the last. */
export interface Piece {
  number: number;
  offset: number;
  total: number;
  bytes: Uint8Array;
}
const kPieceKind = 4;

/** Null: no piece, or one whose length is wrong. */
export function readPiece(buffer: ArrayBuffer): Piece | null {
  if (buffer.byteLength < kHeaderBytes) return null;
  const data = new DataView(buffer);
  if (data.getUint8(0) !== 1 || data.getUint8(1) !== kPieceKind) return null;
  if (buffer.byteLength !== kHeaderBytes + data.getUint32(4, true)) return null;
  return {
    number: data.getUint32(8, true),
    offset: data.getFloat64(16, true),
    total: data.getFloat64(24, true),
    bytes: new Uint8Array(buffer, kHeaderBytes),
  };
}

/** Ticks of the curve of a test, by column. */
export interface CurvePiece {
  seq: number;
  first: number;
  columns: Float64Array[];
}
const kCurveKind = 5;

/** Null: no piece of a curve, or one whose length is wrong. */
export function readCurve(buffer: ArrayBuffer): CurvePiece | null {
  if (buffer.byteLength < kHeaderBytes) return null;
  const data = new DataView(buffer);
  if (data.getUint8(0) !== 1 || data.getUint8(1) !== kCurveKind) return null;
  const columns = data.getUint16(2, true);
  const ticks = data.getUint32(4, true);
  if (buffer.byteLength !== kHeaderBytes + columns * ticks * 8) return null;
  return {
    seq: data.getFloat64(16, true),
    first: data.getFloat64(24, true),
    columns: Array.from({ length: columns }, (_, i) => new Float64Array(buffer, kHeaderBytes + i * ticks * 8, ticks)),
  };
}
