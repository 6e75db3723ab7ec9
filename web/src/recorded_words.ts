// Words for events and frames of a recording, from rc10-web: it has those of rc10d's own log, and each family's frames.

import { useEffect, useState } from 'preact/hooks';

import type { Link } from './link';
import type { EventRow, FrameRow } from './recording_look';

const kMostKept = 4000;
// As AskWords::kMostEvents and kMostFrames of rc10-web: its other pages wait for the answer.
const kMostEvents = 256;
const kMostFrames = 64;

/** Words that are known, by the numbers that they are for. */
export class RecordedWordBook {
  private readonly known = new Map<string, string>();

  constructor(
    private readonly link: Link,
    /** Models of the drives of each bus. */
    private readonly models: string[][],
  ) {}

  event(row: EventRow): string {
    if (row.text !== '') return row.text;
    return this.known.get(eventKey(row)) ?? `event ${row.code} (${row.value}, ${row.extra})`;
  }

  frame(row: FrameRow): string {
    return this.known.get(frameKey(row)) ?? '';
  }

  /** Asks for what is missing, of as many rows as rc10-web answers; true: there is more than before. */
  async learn(events: EventRow[], frames: FrameRow[]): Promise<boolean> {
    const missing = <Row>(rows: Row[], keyOf: (row: Row) => string, most: number): [string, Row][] =>
      [...new Map(rows.map((row): [string, Row] => [keyOf(row), row]))].filter(([key]) => !this.known.has(key)).slice(0, most);
    const wantedEvents = missing(events.filter((row) => row.text === ''), eventKey, kMostEvents);
    const wantedFrames = missing(frames.filter((row) => row.bus < this.models.length), frameKey, kMostFrames);
    if (wantedEvents.length + wantedFrames.length === 0) return false;
    const answer = await this.link.words({
      events: wantedEvents.map(([, row]) => [row.code, row.value, row.extra, row.client]),
      buses: this.models,
      frames: wantedFrames.map(([, row]) => [row.bus, row.sent, row.text]),
    });
    if (answer === null) return false;
    if (this.known.size > kMostKept) this.known.clear();
    wantedEvents.forEach(([key], i) => this.known.set(key, answer.events[i] ?? ''));
    wantedFrames.forEach(([key], i) => this.known.set(key, answer.frames[i] ?? ''));
    return true;
  }
}

function eventKey(row: EventRow): string {
  return `${row.code} ${row.value} ${row.extra} ${row.client}`;
}

function frameKey(row: FrameRow): string {
  return `${row.bus} ${row.sent ? 'T' : 'R'} ${row.text}`;
}

/** Words as they come: the component is drawn anew with each answer. */
export function useWords(book: RecordedWordBook, events: EventRow[], frames: FrameRow[]): void {
  const [, draw] = useState(0);
  useEffect(() => {
    let gone = false;
    void book.learn(events, frames).then((more) => {
      if (more && !gone) draw((n) => n + 1);
    });
    return () => {
      gone = true;
    };
  }, [book, events, frames]);
}
