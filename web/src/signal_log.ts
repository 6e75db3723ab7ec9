// Signals of some ticks, by motor and module; their topics have the names of python -m rc10.export.
import type { Capture } from './captures';
import { download } from './download';
import type { Robot } from './protocol';

export interface SignalLog {
  /** Facts about the whole of it. */
  about: Record<string, string>;
  /** Time of the first tick in µs since 1970. */
  start_us: number;
  period_us: number;
  ticks: number;
  topics: { topic: string; fields: { name: string; unit: string; values: ArrayLike<number | null> }[] }[];
}

type Signal = { name: string; unit: string; values: ArrayLike<number | null> };

/** `modules`: names of those of the robot; all else is a motor. */
function topicsOf(robot: string, modules: Set<string>, signals: Signal[]): SignalLog['topics'] {
  const topics = new Map<string, SignalLog['topics'][number]['fields']>();
  for (const { name, unit, values } of signals) {
    const dot = name.lastIndexOf('.');
    const owner = name.slice(0, dot);
    const topic = `/${robot}/${modules.has(owner) ? 'module' : 'motor'}/${owner}`;
    topics.set(topic, [...(topics.get(topic) ?? []), { name: name.slice(dot + 1), unit, values }]);
  }
  return [...topics].map(([topic, fields]) => ({ topic, fields }));
}

/** `wall_us`: distance of the wall clock of rc10d from its CLOCK_MONOTONIC. */
export function logOfTicks(robot: Robot, signals: Signal[], first: number, period_us: number, wall_us: number): SignalLog {
  const { robot: about, modules } = robot;
  return {
    about: { robot: about.robot, version: about.version, config_hash: about.config_hash, wall_minus_monotonic_us: `${wall_us}` },
    start_us: first * period_us + wall_us,
    period_us,
    ticks: signals[0]?.values.length ?? 0,
    topics: topicsOf(about.robot, new Set(modules.map((module) => module.name)), signals),
  };
}

/** Its times are those of the browser that took it. */
export function logOfCapture(capture: Capture, modules: string[]): SignalLog {
  const ticks = capture.values[0]?.length ?? 0;
  const period_us = capture.period_s * 1e6;
  const signals = capture.signals.map((name, i) => ({ name, unit: capture.units[i] ?? '', values: capture.values[i] ?? [] }));
  const gains = Object.entries(capture.gains).map(([name, value]) => [`gain ${name}`, `${value}`]);
  const taken_us = Date.parse(capture.taken) * 1000;
  return {
    about: {
      robot: capture.robot,
      config_hash: capture.config_hash,
      capture: capture.name,
      trigger_after_s: `${capture.pre_s}`,
      ...Object.fromEntries(gains),
    },
    start_us: (Number.isNaN(taken_us) ? 0 : taken_us) - ticks * period_us,
    period_us,
    ticks,
    topics: topicsOf(capture.robot, new Set(modules), signals),
  };
}

const kMcap = '/mcap.js';

export async function saveMcap(name: string, log: SignalLog): Promise<void> {
  const { mcapOf } = (await import(kMcap)) as typeof import('./mcap_file');
  download(name, await mcapOf(log));
}
