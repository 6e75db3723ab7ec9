// The place in a recording, and steps from one moment to the next.
import { useEffect, useRef } from 'preact/hooks';

import type { Moment, Summary } from './recording_look';

type Step = 'before_us' | 'after_us' | 'tick_before_us' | 'tick_after_us';
// A key that is held presses faster than a phone reads.
const kMostSteps = 8;

export function period_us(summary: Summary): number {
  return 1e6 / (summary.rate_hz > 0 ? summary.rate_hz : 1000);
}

export function within(summary: Summary, at_us: number): number {
  return Math.min(summary.last_us, Math.max(0, at_us));
}

/** The moment to which a step leads; the same where there is none. */
function stepped(from: Moment, step: Step, summary: Summary): number {
  const known_us = from[step];
  if (known_us !== null) return within(summary, known_us);
  if (step === 'tick_before_us') return within(summary, from.at_us - period_us(summary));
  return step === 'tick_after_us' ? within(summary, from.at_us + period_us(summary)) : from.at_us;
}

export interface Place {
  /** To this moment, whatever steps are under way. */
  to: (at_us: number) => void;
  /** One step more: each begins where the one before it ended, also where presses overtake the reader. */
  step: (step: Step) => void;
}

export function usePlace(opened: { at_us: number; summary: Summary } | null, moment: Moment | null, onAt: (at_us: number) => void): Place {
  // Null: where the file was opened.
  const asked_us = useRef<number | null>(null);
  const pending = useRef<Step[]>([]);
  const file = useRef(opened?.summary);
  if (file.current !== opened?.summary) {
    file.current = opened?.summary;
    asked_us.current = null;
    pending.current = [];
  }
  const go = () => {
    if (opened === null || moment === null) return;
    while (moment.at_us === (asked_us.current ?? opened.at_us)) {
      const step = pending.current.shift();
      if (step === undefined) return;
      const next_us = stepped(moment, step, opened.summary);
      if (next_us === moment.at_us) continue;
      asked_us.current = next_us;
      onAt(next_us);
    }
  };
  useEffect(go, [moment]);
  return {
    to: (at_us) => {
      pending.current = [];
      asked_us.current = at_us;
      onAt(at_us);
    },
    step: (step) => {
      if (pending.current.length < kMostSteps) pending.current.push(step);
      go();
    },
  };
}
