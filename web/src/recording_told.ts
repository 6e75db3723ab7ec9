// Damage of a recording, in words.

import type { Damage, Refusal } from './recording';
import type { NotRead } from './recording_reader';
import { number } from './numbers';
import type { Word } from './words';

type WordOf = (word: Word) => string;

function filled(text: string, values: Record<string, string | number>): string {
  return text.replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? ''));
}

const kRefusals: Record<Refusal['why'], Word> = {
  empty: 'boxEmpty',
  no_recording: 'boxNoRecording',
  version: 'boxVersion',
  too_large: 'boxTooLarge',
  too_short: 'boxTooShort',
  header: 'boxHeader',
};

export function notReadText(notRead: NotRead, word: WordOf): string {
  if ('failed' in notRead) return `${word('boxFailed')} ${notRead.failed}`;
  const { why, field, found, most } = notRead.refusal;
  return filled(word(kRefusals[why]), { field: field ?? '', found: found ?? '', most: most ?? '' });
}

const kDamages: Record<Damage['what'], Word> = {
  cut: 'boxCut',
  positions: 'boxPositions',
  broken: 'boxBroken',
  too_many: 'boxTooMany',
};

export function damageText(damage: Damage, word: WordOf): string {
  const after = damage.after_us === null ? word('boxAtStart') : `${number(damage.after_us / 1e6, 3)} s`;
  return filled(word(kDamages[damage.what]), { at: damage.at, bytes: damage.bytes, after });
}
