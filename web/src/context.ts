import { createContext } from 'preact';
import { useContext, useEffect, useState } from 'preact/hooks';

import { remember, remembered } from './browser_memory';
import type { Known, Link } from './link';
import type { Language, Word } from './words';

export interface Studio {
  link: Link;
  word: (word: Word) => string;
  language: Language;
}

export const StudioContext = createContext<Studio | null>(null);

export function useStudio(): Studio {
  const studio = useContext(StudioContext);
  if (studio === null) throw new Error('outside of the studio');
  return studio;
}

/** Newest knowledge of the robot; the component is drawn anew when it changes. */
export function useKnown(): Known {
  const { link } = useStudio();
  const [, draw] = useState(0);
  useEffect(() => link.subscribe(() => draw((n) => n + 1)), [link]);
  return link.known;
}

function stored<T>(key: string, initial: T): T {
  try {
    const text = remembered(`rc10.${key}`);
    return text === null ? initial : (JSON.parse(text) as T);
  } catch {
    return initial;
  }
}

/** A value that this browser remembers. */
export function useStored<T>(key: string, initial: T): [T, (value: T) => void] {
  const [held, hold] = useState<{ key: string; value: T }>(() => ({ key, value: stored(key, initial) }));
  // Another key, such as that of another robot, has another value.
  const now = held.key === key ? held : { key, value: stored(key, initial) };
  if (now !== held) hold(now);
  return [
    now.value,
    (value) => {
      hold({ key, value });
      remember(`rc10.${key}`, JSON.stringify(value));
    },
  ];
}

/** The same of each robot, by its name. */
export function useStoredOfRobot<T>(key: string, initial: T): [T, (value: T) => void] {
  const robot = useKnown().robot?.robot.robot ?? '';
  return useStored(`${robot}/${key}`, initial);
}
