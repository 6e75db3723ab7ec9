// Keys of a motor, and of its loops, in the text of a robot's file.
import { type YamlEntry, type YamlValue, placeIn, textAt } from './yaml_places';

const items = (value: YamlValue | null | undefined) => (value?.kind === 'list' ? value.items : []);
const under = (map: YamlValue, key: string) => map.entries.find((entry) => entry.key === key)?.value;

function motorIn(text: string, name: string): YamlValue | undefined {
  const { root } = placeIn(text, -1);
  return items(under(root, 'buses'))
    .flatMap((bus) => items(under(bus, 'motors')))
    .find((motor) => textAt(motor, 'name') === name);
}

/** Begin and end of a scalar's text behind its key. */
function valueAt(text: string, entry: YamlEntry): [number, number] | null {
  const rest = text.slice(entry.to);
  const before = /^["']?\s*:[ \t]*/.exec(rest)?.[0].length;
  if (before === undefined || entry.value?.kind !== 'scalar') return null;
  const quoted = /^(["'])[^\n]*?\1/.exec(rest.slice(before))?.[0].length;
  return [entry.to + before, entry.to + before + (quoted ?? entry.value.text.length)];
}

function isFlow(text: string, map: YamlValue): boolean {
  const first = map.entries[0];
  return first !== undefined && text.slice(0, first.from).trimEnd().endsWith('{');
}

/** A key of this map; a new one stands behind its name, or behind its first key. */
function withKey(text: string, map: YamlValue | null | undefined, key: string, value: string): string | null {
  const entry = map?.entries.find((each) => each.key === key);
  const named = map?.entries.find((each) => each.key === 'name') ?? map?.entries[0];
  if (map === null || map === undefined || named === undefined) return null;
  if (entry !== undefined) {
    const place = valueAt(text, entry);
    return place === null ? null : text.slice(0, place[0]) + value + text.slice(place[1]);
  }
  const after = valueAt(text, named);
  if (after === null) return null;
  if (isFlow(text, map)) return `${text.slice(0, after[1])}, ${key}: ${value}${text.slice(after[1])}`;
  const lineEnd = text.indexOf('\n', after[1]);
  const at = lineEnd < 0 ? text.length : lineEnd;
  const column = named.from - (text.lastIndexOf('\n', named.from - 1) + 1);
  return `${text.slice(0, at)}\n${' '.repeat(column)}${key}: ${value}${text.slice(at)}`;
}

/** The text with these keys of a motor; null: the motor was not found in it. Comments and order stay. */
export function withMotorKeys(text: string, name: string, keys: Record<string, number>): string | null {
  let changed: string | null = text;
  for (const [key, value] of Object.entries(keys)) {
    if (changed === null) return null;
    changed = withKey(changed, motorIn(changed, name), key, String(value));
  }
  return changed;
}

/** Begin and end of a map in braces behind its key; null: it stands in lines of its own. */
function bracesAt(text: string, entry: YamlEntry): [number, number] | null {
  const found = /^["']?\s*:\s*(?=\{)/.exec(text.slice(entry.to))?.[0].length;
  if (found === undefined) return null;
  const end = text.indexOf('}', entry.to + found);
  return end < 0 ? null : [entry.to + found, end + 1];
}

function withLoop(text: string, name: string, loop: string, braces: string): string | null {
  const found = (of: string) => motorIn(of, name)?.entries.find((each) => each.key === loop);
  const entry = found(text);
  if (entry === undefined) return withKey(text, motorIn(text, name), loop, braces);
  const place = bracesAt(text, entry);
  if (place !== null) return text.slice(0, place[0]) + braces + text.slice(place[1]);
  if (entry.value?.kind !== 'map') return null;
  let changed: string | null = text;
  for (const [, key = '', value = ''] of braces.matchAll(/(\w+): ([^,}]+)/g)) {
    if (changed === null) return null;
    changed = withKey(changed, found(changed)?.value, key, value);
  }
  return changed;
}

/** The text with these lines of a motor's loops, as `rc10ctl gains --save` prints them; null: they found no place in it. */
export function withMotorLoops(text: string, name: string, lines: string): string | null {
  let changed: string | null = text;
  for (const [, loop = '', braces = ''] of lines.matchAll(/^(\w+): (\{.*\})$/gm)) {
    if (changed === null) return null;
    changed = withLoop(changed, name, loop, braces);
  }
  return changed;
}

/** The text with a motor more, the first of its bus; null: there is no list of motors in blocks. */
export function withNewMotor(text: string, bus: string, motor: string): string | null {
  const { root } = placeIn(text, -1);
  const found = items(under(root, 'buses')).find((each) => textAt(each, 'name') === bus);
  const first = found === undefined ? undefined : items(under(found, 'motors'))[0]?.entries[0];
  if (first === undefined) return null;
  const lineBegin = text.lastIndexOf('\n', first.from - 1) + 1;
  const dash = /^([ \t]*)- *\{? *["']?$/.exec(text.slice(lineBegin, first.from));
  return dash === null ? null : `${text.slice(0, lineBegin)}${dash[1] ?? ''}- ${motor}\n${text.slice(lineBegin)}`;
}
