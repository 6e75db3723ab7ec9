import { createContext } from 'preact';
import { useContext, useEffect, useState } from 'preact/hooks';

import type { Known, Link } from './link';
import type { Word } from './words';

export interface Studio {
  link: Link;
  word: (word: Word) => string;
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

/** A value that this browser remembers. */
export function useStored<T>(key: string, initial: T): [T, (value: T) => void] {
  const [value, setValue] = useState<T>(() => {
    try {
      const stored = localStorage.getItem(`rc10.${key}`);
      return stored === null ? initial : (JSON.parse(stored) as T);
    } catch {
      return initial;
    }
  });
  return [
    value,
    (next) => {
      setValue(next);
      localStorage.setItem(`rc10.${key}`, JSON.stringify(next));
    },
  ];
}
