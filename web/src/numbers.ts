/** With as many digits as a person reads; "–": not reported. */
export function number(value: number | null | undefined, digits = 1): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text.replace('-', '−');
}

export function percent(share: number): string {
  return `${number(100 * share, 0)} %`;
}

/** Microseconds in the unit that a person would use. */
export function duration(us: number): string {
  if (us < 0) return '–';
  if (us < 1000) return `${us.toFixed(0)} µs`;
  if (us < 1e6) return `${(us / 1000).toFixed(us < 1e4 ? 1 : 0)} ms`;
  return `${(us / 1e6).toFixed(us < 1e7 ? 1 : 0)} s`;
}

/** An angle as people mean it near zero: -180 to 180 for one turn. */
export function signedAngle(deg: number | null): number | null {
  if (deg === null) return null;
  const turned = ((((deg + 180) % 360) + 360) % 360) - 180;
  return turned;
}

const kUnits: [RegExp, string][] = [
  [/_deg_per_s$/, '°/s'],
  [/_m_per_s$/, 'm/s'],
  [/_deg$/, '°'],
  [/_rpm$/, 'rpm'],
  [/_a$/, 'A'],
  [/_nm$/, 'N·m'],
  [/_v$/, 'V'],
  [/_c$/, '°C'],
  [/_us$/, 'µs'],
  [/_hz$/, 'Hz'],
  [/_m$/, 'm'],
];

/** Unit of a signal by its name; "": none. */
export function unitOf(signal: string): string {
  return kUnits.find(([ending]) => ending.test(signal))?.[1] ?? '';
}

const kModeUnits: Record<string, string> = {
  current: 'A',
  velocity: 'rpm',
  angle: '°',
  total_angle: '°',
  impedance: '°',
  voltage: 'V',
};

export function unitOfMode(mode: string): string {
  return kModeUnits[mode] ?? '';
}
