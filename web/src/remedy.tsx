// A link from an event to its remedy in docs/troubleshooting.md, which rc10-web serves.
import { useEffect, useState } from 'preact/hooks';

import { useStudio } from './context';
import { fetchedOnce } from './fetched_once';
import type { RobotEvent } from './protocol';

/** Messages of each row of the page; "…" stands for names and numbers. */
type Messages = string[][];

// Shorter ones are in many texts.
const kLeastLetters = 12;

const messages = fetchedOnce('/docs/messages.json', (rows) => rows as Messages);

/** Letters of the message that are in the text, in their order; 0: not all of them are. */
function likeness(message: string, text: string): number {
  let from = 0;
  let letters = 0;
  for (const part of message.split('…').map((each) => each.trim())) {
    const at = text.indexOf(part, from);
    if (at < 0) return 0;
    from = at + part.length;
    letters += part.length;
  }
  return letters;
}

function rowOf(text: string, rows: Messages): string | null {
  let best = kLeastLetters - 1;
  let found: string | null = null;
  rows.forEach((row, i) => {
    for (const message of row) {
      const letters = likeness(message, text);
      if (letters <= best) continue;
      best = letters;
      found = `row-${i + 1}`;
    }
  });
  return found;
}

const kSections: Record<number, string> = {
  101: 'it-moves-and-not-as-told',
  102: 'it-moves-and-not-as-told',
  103: 'it-is-ready-and-does-not-move',
  104: 'it-is-ready-and-does-not-move',
  105: 'fault',
  106: 'it-is-ready-and-does-not-move',
  108: 'it-moves-and-not-as-told',
  109: 'it-moves-and-not-as-told',
  112: 'a-motor-is-offline',
  113: 'it-moves-and-not-as-told',
  200: 'it-is-ready-and-does-not-move',
  201: 'late',
  202: 'lcm-and-programs',
  203: 'it-is-ready-and-does-not-move',
  204: 'it-moves-and-not-as-told',
  205: 'late',
  300: 'a-motor-is-offline',
  301: 'a-motor-is-offline',
  302: 'a-motor-is-offline',
  310: 'serial-devices-gpio-spi',
  311: 'serial-devices-gpio-spi',
  400: 'lcm-and-programs',
  401: 'lcm-and-programs',
  402: 'lcm-and-programs',
};

function sectionOf(event: RobotEvent): string | null {
  if (event.severity === 'info') return null;
  // A motor's status, in words.
  if (event.code === 100 && event.text.includes('OFFLINE')) return 'a-motor-is-offline';
  if (event.code === 100 && event.text.includes('FAULT')) return 'fault';
  return kSections[event.code] ?? null;
}

/** Nothing for what needs no remedy. */
export function Remedy(props: { event: RobotEvent }) {
  const { word, language } = useStudio();
  const [rows, setRows] = useState<Messages>([]);
  useEffect(() => void messages().then((found) => setRows(found ?? [])), []);
  const place = rowOf(props.event.text, rows) ?? sectionOf(props.event);
  if (place === null) return null;
  const page = language === 'zh' ? 'troubleshooting.zh.html' : 'troubleshooting.html';
  return (
    <a class="remedy-link" href={`/docs/${page}#${place}`} target="_blank" rel="noopener">
      {word('remedy')}
    </a>
  );
}
