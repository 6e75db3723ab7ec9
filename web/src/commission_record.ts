// Commissioning of one motor: what each step found, judged as `rc10ctl commission` judges it (src/client/hand_turn.cpp,
// src/client/first_spin.cpp), and what follows from it for the robot's file.
import { number } from './numbers';
import type { CheckedMotor, MotorState, Robot, RobotEvent, TestDone } from './protocol';
import type { Word } from './words';

export const kSteps = ['bus', 'hand', 'zero', 'limits', 'spin', 'step', 'end'] as const;
export type Step = (typeof kSteps)[number];
export type Measured = Exclude<Step, 'end'>;

/** Outcome of a step, in words that are chosen when it is shown. */
export interface Finding {
  at: string;
  /** SHA-256 of the file that ran. */
  hash: string;
  /** Process of rc10d: another one may count from another zero. */
  pid: number;
  good: boolean;
  word: Word;
  values: Record<string, string>;
}

/** Keys of the motor in the robot's file that the steps have found. */
export type Lines = Partial<Record<'direction' | 'gear_ratio' | 'zero_deg' | 'angle_min_deg' | 'angle_max_deg', number>>;

/** Record of a motor in this browser: nothing of it acts. */
export interface CommissionRecord {
  shown: Step;
  found: Partial<Record<Measured, Finding>>;
  lines: Lines;
  zero_deg: number;
  low_deg: number | null;
  high_deg: number | null;
  margin_deg: number;
  current_a: number;
  over_speed_rpm: number;
  step_max_current_a: number;
}

export const kFirstRecord: CommissionRecord = {
  shown: 'bus',
  found: {},
  lines: {},
  zero_deg: 0,
  low_deg: null,
  high_deg: null,
  margin_deg: 2,
  current_a: 1,
  over_speed_rpm: 60,
  step_max_current_a: 6,
};

/** Found with the file that runs; the zero and what counts from it in this run of rc10d, too. */
export function holdsNow(step: Measured, finding: Finding | undefined, robot: Robot): boolean {
  if (finding === undefined || finding.hash !== robot.robot.config_hash) return false;
  return (step !== 'zero' && step !== 'limits') || finding.pid === robot.robot.pid;
}

const kFoundBy: Record<keyof Lines, Measured> = {
  direction: 'hand',
  gear_ratio: 'hand',
  zero_deg: 'zero',
  angle_min_deg: 'limits',
  angle_max_deg: 'limits',
};

/** Lines of the findings for which this holds. */
export function linesOf(lines: Lines, holds: (step: Measured) => boolean): Lines {
  return Object.fromEntries(Object.entries(lines).filter(([key]) => holds(kFoundBy[key as keyof Lines])));
}

/** Steps that must be right before one that moves the motor. */
export const kNeeds: Partial<Record<Step, Measured[]>> = { spin: ['hand', 'limits'], step: ['hand', 'limits', 'spin'] };

export type Judged = Pick<Finding, 'good' | 'word' | 'values'> & { lines?: Lines };

// A shaft that was touched, or the play of a gearbox.
const kNothingDeg = 20;
const kHandError = 0.15;

// The code of the event that tells of a lost angle: docs/lcm.md.
const kReferenceLost = 102;

/** Whether a gap in a motor's feedback may have hidden a turn since then. */
export function hasLostItsAngle(events: RobotEvent[], motor: string, since_us: number): boolean {
  return events.some((event) => event.code === kReferenceLost && event.source === motor && event.mono_us > since_us);
}

/** One whole turn counter-clockwise by hand: angles before and after it, by motor. */
export function judgeHandTurn(
  motor: string,
  before: Record<string, number>,
  after: Record<string, number>,
  checked: CheckedMotor | null,
  angleLost: boolean,
): Judged {
  const turned = (name: string) => {
    const difference = (after[name] ?? NaN) - (before[name] ?? NaN);
    return Number.isFinite(difference) ? difference : 0;
  };
  const most = Object.keys(before).reduce((found, name) => (Math.abs(turned(name)) > Math.abs(turned(found)) ? name : found), motor);
  const own = turned(motor);
  const values = { motor, other: most, deg: number(turned(most)), own: number(own) };
  if (angleLost) return { good: false, word: 'comHandLost', values };
  if (Math.abs(turned(most)) < kNothingDeg) return { good: false, word: 'comHandNothing', values };
  if (most !== motor && Math.abs(own) < kNothingDeg) return { good: false, word: 'comHandOther', values };
  const factor = Math.abs(own) / 360;
  const lines: Lines = {};
  if (own < 0) lines.direction = -(checked?.direction ?? 1);
  if (Math.abs(factor - 1) <= kHandError) return own < 0 ? { good: false, word: 'comHandSign', values, lines } : { good: true, word: 'comHandGood', values };
  if (checked !== null) lines.gear_ratio = Number((checked.gear_ratio * factor).toPrecision(4));
  return { good: false, word: 'comHandRatio', values: { ...values, factor: number(factor, 3) }, lines };
}

const kLeastTurnDeg = 5;
const kCurve = { target: 1, angle: 4, velocity: 5 } as const;
const kEndsBeforeItsTime = ['velocity', 'angle'];

/** A small positive current; null: it was ended before anything could be judged. */
export function judgeSpin(motor: string, done: TestDone, curve: number[][], angleLost: boolean): Judged | null {
  const { report } = done;
  const column = (name: keyof typeof kCurve) => curve[kCurve[name]] ?? [];
  const begin = column('target').findIndex((target) => target > 0);
  const fast = report.abort?.criterion === 'velocity';
  const last = column('angle').length - 1;
  const velocity = column('velocity')[last] ?? NaN;
  const turned = (column('angle')[last] ?? NaN) - (column('angle')[begin] ?? NaN);
  const values = { motor, deg: number(turned), rpm: number(velocity, 0), current: number(report.largest_current_a, 2) };
  if (angleLost) return { good: false, word: 'comSpinLost', values };
  if (begin < 0) return fast ? { good: false, word: 'comSpinSoon', values } : null;
  if (report.abort !== null && !kEndsBeforeItsTime.includes(report.abort.criterion)) return null;
  if (!Number.isFinite(turned) || !Number.isFinite(velocity)) return { good: false, word: 'comSpinUnknown', values };
  if (fast && velocity * turned <= 0) return { good: false, word: 'comSpinDisagree', values };
  if (!fast && Math.abs(turned) < kLeastTurnDeg)
    return { good: false, word: report.limits.includes('angle') ? 'comSpinAtLimit' : 'comSpinStill', values };
  return turned > 0 ? { good: true, word: 'comSpinGood', values } : { good: false, word: 'comSpinWrong', values };
}

/** The first step of a loop; null: it was ended before its time. */
export function judgeStep(motor: string, done: TestDone, amplitude: number, curve: number[][]): Judged | null {
  const { report } = done;
  if (report.abort !== null) return null;
  const measured = curve[3] ?? [];
  const tail = measured.slice(-Math.max(1, Math.round(measured.length / 10)));
  const reached = tail.reduce((sum, value) => sum + value, 0) / tail.length - (report.mode === 'total_angle' ? report.origin : 0);
  const good = reached / amplitude > 0.5 && reached / amplitude < 1.5;
  const milliseconds = (value_s: number | null | undefined) => (value_s === null || value_s === undefined ? '–' : number(value_s * 1000, 0));
  const values = {
    motor,
    wanted: number(amplitude),
    reached: number(reached),
    unit: report.unit,
    rise: milliseconds(report.step?.rise_s),
    overshoot: number(report.step?.overshoot_percent),
    settling: milliseconds(report.step?.settling_s),
    current: number(report.largest_current_a, 2),
  };
  return { good, word: good ? 'comStepGood' : 'comStepBad', values };
}

/** Limits a margin within both ends, or why there are none. */
export function judgeLimits(low: number, high: number, margin: number): Judged {
  const min = Math.ceil((low + margin) * 10) / 10;
  const max = Math.floor((high - margin) * 10) / 10;
  const values = { low: number(min), high: number(max), travel: number(max - min) };
  if (!(max > min)) return { good: false, word: 'comLimitsNone', values };
  return { good: true, word: 'comLimitsGood', values, lines: { angle_min_deg: min, angle_max_deg: max } };
}

/** Range in which an absolute encoder is read on its right turn at power-up; null: the turn is not known. */
export function turnRange(min: number | undefined, max: number | undefined): [number, number] | null {
  if (min === undefined || max === undefined || max - min >= 358) return null;
  const gap = (360 - (max - min)) / 2;
  return [min - gap + 1, max + gap - 1];
}

/** "at 12.5 deg" of an absolute encoder: 12.5; null: it is none. */
export function absoluteZero(checked: CheckedMotor | null): number | null {
  const found = /^at (-?[\d.e+-]+) deg$/.exec(checked?.zero ?? '');
  return found === null ? null : Number(found[1]);
}

export const isOn = (motor: MotorState | undefined) => motor?.status === 'ACTIVE' || motor?.status === 'ENABLING';

export function angles(motors: MotorState[]): Record<string, number> {
  return Object.fromEntries(motors.map((motor) => [motor.name, motor.total_angle_deg ?? NaN]));
}
