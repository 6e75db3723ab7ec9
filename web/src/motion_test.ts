// A test of motion: what a person sets before it, the lines that do the same elsewhere, and what came of it.
import type { Capture } from './captures';

export type TestKind = 'step' | 'ramp' | 'sweep' | 'multisine';
export type TestMode = 'velocity' | 'total_angle' | 'current';
export const kTestKinds: TestKind[] = ['step', 'ramp', 'sweep', 'multisine'];
export const kTestModes: TestMode[] = ['velocity', 'total_angle', 'current'];
export const kTestUnits: Record<TestMode, string> = { velocity: 'rpm', total_angle: '°', current: 'A' };

/** Null: its default. Names and units are those of the message "test" (src/web/page_request.cpp). */
export interface TestPlan {
  kind: TestKind;
  mode: TestMode;
  amplitude: number;
  base: number;
  seconds: number | null;
  rate_per_s: number | null;
  from_hz: number;
  to_hz: number;
  linear: boolean;
  /** Null: not entered yet; without it no test begins. */
  max_current_a: number | null;
  max_speed_rpm: number | null;
  min_angle_deg: number | null;
  max_angle_deg: number | null;
  max_feedback_age_ms: number;
  stop_at_limits: boolean;
  dead_man_ms: number;
}

export const kFirstPlan: TestPlan = {
  kind: 'step',
  mode: 'velocity',
  amplitude: 60,
  base: 0,
  seconds: null,
  rate_per_s: null,
  from_hz: 1,
  to_hz: 20,
  linear: false,
  max_current_a: null,
  max_speed_rpm: null,
  min_angle_deg: null,
  max_angle_deg: null,
  max_feedback_age_ms: 200,
  stop_at_limits: false,
  dead_man_ms: 200,
};

export const isSines = (kind: TestKind) => kind === 'sweep' || kind === 'multisine';

/** A plan without what its kind and mode do not have. */
export function planOf(plan: TestPlan): TestPlan {
  return {
    ...plan,
    base: plan.mode === 'total_angle' ? 0 : plan.base,
    rate_per_s: plan.kind === 'ramp' ? plan.rate_per_s : null,
    linear: plan.kind === 'sweep' && plan.linear,
    from_hz: isSines(plan.kind) ? plan.from_hz : kFirstPlan.from_hz,
    to_hz: isSines(plan.kind) ? plan.to_hz : kFirstPlan.to_hz,
  };
}

// Options of rc10ctl and of Python that differ from their defaults.
function chosen(plan: TestPlan): Partial<TestPlan> {
  return Object.fromEntries(
    Object.entries(planOf(plan)).filter(([key, value]) => value !== null && value !== kFirstPlan[key as keyof TestPlan]),
  );
}

const kOptions: [keyof TestPlan, (plan: TestPlan) => string][] = [
  ['max_current_a', (plan) => `--max-current ${plan.max_current_a}`],
  ['mode', (plan) => `--mode ${plan.mode}`],
  ['base', (plan) => `--base ${plan.base}`],
  ['seconds', (plan) => `--for ${plan.seconds}s`],
  ['rate_per_s', (plan) => `--rate ${plan.rate_per_s}`],
  ['from_hz', (plan) => `--from ${plan.from_hz}`],
  ['to_hz', (plan) => `--to ${plan.to_hz}`],
  ['linear', () => '--linear'],
  ['max_speed_rpm', (plan) => `--max-speed ${plan.max_speed_rpm}`],
  ['min_angle_deg', (plan) => `--min-angle ${plan.min_angle_deg}`],
  ['max_angle_deg', (plan) => `--max-angle ${plan.max_angle_deg}`],
  ['max_feedback_age_ms', (plan) => `--max-feedback-age ${plan.max_feedback_age_ms}ms`],
  ['stop_at_limits', () => '--stop-at-limits'],
  ['dead_man_ms', (plan) => `--dead-man-ms ${plan.dead_man_ms}`],
];

export function testCommand(motor: string, plan: TestPlan): string {
  const set = chosen(plan);
  const options = kOptions.filter(([key]) => key in set).map(([, text]) => text(plan));
  return ['rc10ctl test-motion', motor, plan.kind, String(plan.amplitude), ...options].join(' ');
}

export function testPython(motor: string, plan: TestPlan): string {
  const { kind: _kind, amplitude: _amplitude, max_feedback_age_ms, ...set } = chosen(plan);
  const words = Object.entries(set).map(([key, value]) => {
    const text = typeof value === 'string' ? `"${value}"` : value === true ? 'True' : String(value);
    return `${key}=${text}`;
  });
  if (max_feedback_age_ms !== undefined) words.push(`max_feedback_age_s=${max_feedback_age_ms / 1000}`);
  return `run_motion_test("${motor}", "${plan.kind}", ${[plan.amplitude, ...words].join(', ')})`;
}

/** Stiffness and damping of angle targets with which a motor that only has inertia is critically damped with this time
 * constant: with inertia J, torque by each ampere over acceleration by each ampere, k = J / T², d = 2 J / T. */
export function springOf(acceleration_rpm_s_per_a: number, torque_nm_per_a: number, time_constant_s: number): Record<string, number> | null {
  const inertia = torque_nm_per_a / ((acceleration_rpm_s_per_a * Math.PI) / 30);
  const t = time_constant_s;
  if (!(inertia > 0) || !Number.isFinite(inertia) || !(t > 0)) return null;
  const rounded = (value: number) => Number(value.toPrecision(3));
  return { angle_stiffness_nm_per_rad: rounded(inertia / t ** 2), angle_damping_nms_per_rad: rounded((2 * inertia) / t) };
}

/** Report of a test, as `rc10ctl test-motion --json` has it; null: not within the test. */
export interface TestReport {
  motor: string;
  kind: TestKind;
  mode: TestMode;
  unit: string;
  origin: number;
  ticks: number;
  abort: { criterion: string; value: number | null; limit: number | null; unit: string; text: string } | null;
  following_error: { rms: number | null; max: number | null };
  largest_velocity_rpm: number | null;
  largest_current_a: number | null;
  limits: string[];
  step: { rise_s: number | null; overshoot_percent: number | null; settling_s: number | null; steady_error: number | null } | null;
  acceleration_rpm_per_s: number | null;
  bandwidth_hz: number | null;
  phase_margin_deg: number | null;
  phase_margin_at_hz: number | null;
  gain_margin_db: number | null;
  gain_margin_at_hz: number | null;
  response: { frequency_hz: number; gain_db: number; phase_deg: number; coherence: number }[];
}

/** Columns of a curve, by their places in it: those of `rc10ctl test-motion --csv`. */
export const kCurveColumns = [
  'time_s',
  'target',
  'target_shaped',
  'measured',
  'total_angle_deg',
  'velocity_rpm',
  'current_a',
  'feedback_age_us',
  'limits',
] as const;

export interface TestResult {
  id: string;
  name: string;
  plan: TestPlan;
  report: TestReport;
  /** Gains in force when it began; empty: rc10d closes no loop of the motor. */
  gains: Record<string, number>;
  /** By column, each tick. */
  curve: number[][];
}

const kMostDrawn = 4000;
/** Time from the start of the approach to that of the excitation. */
const kLeadS = 1;

/** For the picture of captures: the target within the motor's limits, what follows it, and the current. */
export function captureOf(result: TestResult): Capture {
  const unit = kTestUnits[result.report.mode];
  const rows = [2, 3, result.report.mode === 'current' ? 5 : 6];
  const every = Math.max(1, Math.ceil((result.curve[0]?.length ?? 0) / kMostDrawn));
  const origin = result.report.mode === 'total_angle' ? result.report.origin : 0;
  const thinned = rows.map((row, i) =>
    (result.curve[row] ?? []).filter((_, at) => at % every === 0).map((value) => (Number.isNaN(value) ? null : i < 2 ? value - origin : value)),
  );
  const times = result.curve[0] ?? [];
  const period_s = times.length > 1 ? (((times[times.length - 1] ?? 0) - (times[0] ?? 0)) / (times.length - 1)) * every : 0.001;
  return {
    id: result.id,
    name: result.name,
    taken: '',
    robot: '',
    config_hash: '',
    gains: result.gains,
    signals: ['target', 'measured', 'current'],
    units: [unit, unit, result.report.mode === 'current' ? 'rpm' : 'A'],
    period_s,
    pre_s: kLeadS,
    values: thinned,
  };
}

export function curveCsv(result: TestResult): string {
  const ticks = (result.curve[0] ?? []).map((_, i) => result.curve.map((column) => String(column[i])).join(','));
  return `${[kCurveColumns.join(','), ...ticks].join('\n')}\n`;
}

export function bodeCsv(result: TestResult): string {
  const points = result.report.response.map((point) => `${point.frequency_hz},${point.gain_db},${point.phase_deg},${point.coherence}`);
  return `${['frequency_hz,gain_db,phase_deg,coherence', ...points].join('\n')}\n`;
}

/** Gains of a velocity loop that is critically damped with this time constant, of a motor that only has inertia:
 * with acceleration b by each ampere kp = 2 / (b T), ki = 1 / (b T²). Null: it does not accelerate. */
export function proposalOf(acceleration_rpm_s_per_a: number, time_constant_s: number): Record<string, number> | null {
  const b = acceleration_rpm_s_per_a;
  const t = time_constant_s;
  if (!(b > 0) || !(t > 0)) return null;
  const rounded = (value: number) => Number(value.toPrecision(4));
  return { 'velocity_pid.kp_a_per_rpm': rounded(2 / (b * t)), 'velocity_pid.ki_a_per_rpm_s': rounded(1 / (b * t * t)) };
}
