// Places in the text of a configuration: which key is where, also while the text is not yet YAML. It reads the forms that
// robots are written in: blocks by their indentation, and {...} and [...] in them. rc10d reads the file itself.

export interface YamlEntry {
  key: string;
  from: number;
  to: number;
  value: YamlValue | null;
}

export interface YamlValue {
  kind: 'map' | 'list' | 'scalar';
  parent: YamlValue | null;
  /** Key in the parent; of an item of a list "". */
  key: string;
  entries: YamlEntry[];
  items: YamlValue[];
  text: string;
}

/** Where the cursor is: in a map, at a key or at the value of one. */
export interface Place {
  map: YamlValue;
  entry: YamlEntry | null;
  /** Where the word before the cursor begins: of a key without an entry, of the value with one. */
  from: number;
}

const kKey = /^(?:"([^"]*)"|'([^']*)'|([^\s#{}[\],&*!|>'"%@`:-][^#{}[\],:]*?|-[^\s#{}[\],:][^#{}[\],:]*?))\s*:(?=\s|$)/;

function made(kind: YamlValue['kind'], parent: YamlValue | null, key: string): YamlValue {
  return { kind, parent, key, entries: [], items: [], text: '' };
}

interface Open {
  value: YamlValue;
  column: number;
}

class Reader {
  readonly root = made('map', null, '');
  place: Place | null = null;
  private at = 0;

  constructor(
    private readonly text: string,
    private readonly cursor: number,
  ) {}

  read(): void {
    const open: Open[] = [{ value: this.root, column: 0 }];
    while (this.at < this.text.length) this.line(open);
    if (this.place === null) this.missing(open, this.cursor);
  }

  private endOfLine(): number {
    const end = this.text.indexOf('\n', this.at);
    return end < 0 ? this.text.length : end;
  }

  /** A line without an entry: the place is that of a key that is to come. */
  private missing(open: Open[], from: number): void {
    const begin = this.text.lastIndexOf('\n', this.cursor - 1) + 1;
    const column = from - begin;
    const above = open.filter((each) => each.column <= column || each.value === this.root);
    const last = above[above.length - 1];
    if (last === undefined) return;
    const slot = last.value.kind === 'map' ? last.value.entries[last.value.entries.length - 1] : undefined;
    // Deeper than the last map, and its last key has no value yet.
    if (slot !== undefined && slot.value === null && last.column < column) {
      this.place = { map: made('map', last.value, slot.key), entry: null, from };
    } else if (last.value.kind === 'list') {
      this.place = { map: made('map', last.value, ''), entry: null, from };
    } else {
      this.place = { map: last.value, entry: null, from };
    }
  }

  private line(open: Open[]): void {
    const begin = this.at;
    const end = this.endOfLine();
    const line = this.text.slice(begin, end);
    const holds = this.cursor >= begin && this.cursor <= end;
    let column = line.length - line.trimStart().length;
    if (column === line.length || line[column] === '#') {
      if (holds && (column === line.length || this.cursor <= begin + column)) this.missing(open, this.cursor);
      this.at = end + 1;
      return;
    }
    const before = [...open];
    while (line[column] === '-' && (column + 1 === line.length || line[column + 1] === ' ')) {
      this.item(open, column);
      column += 1;
      while (line[column] === ' ') column += 1;
    }
    const found = kKey.exec(line.slice(column));
    if (found === null) return this.noKey(open, before, begin, column, end, holds);
    const map = this.mapAt(open, column);
    const key = found[1] ?? found[2] ?? found[3] ?? '';
    const entry: YamlEntry = { key, from: begin + column, to: begin + column + key.length, value: null };
    map.entries.push(entry);
    this.at = begin + column + found[0].length;
    this.valueOf(map, entry, end, holds);
  }

  private noKey(open: Open[], before: Open[], begin: number, column: number, end: number, holds: boolean): void {
    this.at = begin + column;
    const last = open[open.length - 1];
    if (last !== undefined && last.value.kind === 'list' && '{['.includes(this.text[this.at] ?? ' ')) {
      last.value.items.push(this.flow(last.value, ''));
    } else if (holds) {
      const from = this.text.slice(begin + column, this.cursor).trimStart() === '' ? this.cursor : begin + column;
      this.missing(open.length === 0 ? before : open, Math.min(from, this.cursor));
    }
    this.at = Math.max(this.at, end) + 1;
  }

  /** The rest of a line behind a key. */
  private valueOf(map: YamlValue, entry: YamlEntry, end: number, holds: boolean): void {
    while (this.at < end && this.text[this.at] === ' ') this.at += 1;
    const from = this.at;
    if ('{['.includes(this.text[from] ?? ' ')) {
      if (holds && this.cursor <= from) this.place = { map, entry, from: this.cursor };
      entry.value = this.flow(map, entry.key);
      this.at = Math.max(this.at, this.endOfLine()) + 1;
      return;
    }
    const rest = this.text.slice(from, end);
    const scalar = rest.replace(/(^|\s)#.*$/, '').trim();
    if (scalar !== '') {
      entry.value = made('scalar', map, entry.key);
      entry.value.text = scalar.replace(/^(["'])(.*)\1$/, '$2');
    }
    if (holds && this.cursor >= entry.from) this.place = { map, entry, from: Math.min(from, this.cursor) };
    else if (holds) this.place = { map, entry: null, from: this.cursor };
    this.at = end + 1;
  }

  private item(open: Open[], column: number): void {
    while (open.length > 1 && (open[open.length - 1] as Open).column > column) open.pop();
    let last = open[open.length - 1] as Open;
    if (last.value.kind === 'map') {
      const slot = last.value.entries[last.value.entries.length - 1];
      if (slot === undefined) return;
      slot.value ??= made('list', last.value, slot.key);
      last = { value: slot.value, column };
      open.push(last);
    }
  }

  private mapAt(open: Open[], column: number): YamlValue {
    while (open.length > 1) {
      const last = open[open.length - 1] as Open;
      // "buses:" and its "- " may stand in the same column.
      if (last.column < column || (last.column === column && last.value.kind === 'map')) break;
      open.pop();
    }
    const last = open[open.length - 1] as Open;
    if (last.value.kind === 'map' && (last.column === column || last.value.entries.length === 0)) {
      last.column = column;
      return last.value;
    }
    let map: YamlValue;
    if (last.value.kind === 'list') {
      map = made('map', last.value, '');
      last.value.items.push(map);
    } else {
      const slot = last.value.entries[last.value.entries.length - 1] as YamlEntry;
      map = made('map', last.value, slot.key);
      slot.value ??= map;
    }
    open.push({ value: map, column });
    return map;
  }

  private skipBlank(): void {
    for (;;) {
      while (/\s/.test(this.text[this.at] ?? '')) this.at += 1;
      if (this.text[this.at] !== '#') return;
      this.at = this.endOfLine();
    }
  }

  /** A word in {...} or [...], up to what ends it. */
  private word(): string {
    const from = this.at;
    const quote = this.text[from];
    if (quote === '"' || quote === "'") {
      const end = this.text.indexOf(quote, from + 1);
      this.at = end < 0 ? this.endOfLine() : end + 1;
      return this.text.slice(from + 1, this.at - 1);
    }
    while (this.at < this.text.length) {
      const sign = this.text[this.at] as string;
      if (',{}[]\n'.includes(sign) || (sign === ':' && /[\s,}\]]|$/.test(this.text[this.at + 1] ?? ''))) break;
      this.at += 1;
    }
    return this.text.slice(from, this.at).trim();
  }

  /** {...} or [...], which may go on in later lines. */
  private flow(parent: YamlValue, key: string): YamlValue {
    const isMap = this.text[this.at] === '{';
    const value = made(isMap ? 'map' : 'list', parent, key);
    this.at += 1;
    while (this.at < this.text.length) {
      const start = this.at;
      this.skipBlank();
      const sign = this.text[this.at];
      if (sign === undefined) break;
      // Nothing but a word to come.
      if (isMap && this.place === null && this.cursor >= start && this.cursor <= this.at && sign !== ':')
        this.place = { map: value, entry: null, from: this.cursor };
      if (sign === '}' || sign === ']') {
        this.at += 1;
        return value;
      }
      if (sign === ',' || sign === ':') {
        this.at += 1;
      } else if (isMap) {
        this.flowEntry(value);
      } else if (sign === '{' || sign === '[') {
        value.items.push(this.flow(value, ''));
      } else {
        const item = made('scalar', value, '');
        const from = this.at;
        item.text = this.word();
        value.items.push(item);
        if (this.cursor >= from && this.cursor <= this.at) this.ofList(value, from);
      }
      if (this.at === start) this.at += 1;
    }
    return value;
  }

  /** The cursor is in a list of words: the place is its key's. */
  private ofList(list: YamlValue, from: number): void {
    const map = list.parent;
    const entry = map?.kind === 'map' ? (map.entries.find((each) => each.key === list.key) ?? null) : null;
    if (map !== null && entry !== null) this.place = { map, entry, from };
  }

  private flowEntry(map: YamlValue): void {
    const from = this.at;
    if ('{['.includes(this.text[from] ?? ' ')) {
      this.flow(map, '');
      return;
    }
    const key = this.word();
    const to = this.at;
    if (this.text[this.at] !== ':') {
      if (this.cursor >= from && this.cursor <= to) this.place = { map, entry: null, from };
      return;
    }
    const entry: YamlEntry = { key, from, to, value: null };
    map.entries.push(entry);
    if (this.cursor >= from && this.cursor <= to) this.place = { map, entry, from: this.cursor };
    this.at += 1;
    const begin = this.at;
    this.skipBlank();
    const valueFrom = this.at;
    const sign = this.text[this.at];
    if (sign === '{' || sign === '[') {
      entry.value = this.flow(map, key);
      return;
    }
    if (sign !== undefined && !',}]'.includes(sign)) {
      entry.value = made('scalar', map, key);
      entry.value.text = this.word();
    }
    if (this.cursor >= begin && this.cursor <= this.at) {
      this.place = { map, entry, from: Math.min(valueFrom, this.cursor) };
    }
  }
}

export function placeIn(text: string, cursor: number): { root: YamlValue; place: Place | null } {
  const reader = new Reader(text, cursor);
  reader.read();
  return { root: reader.root, place: reader.place };
}

export function textAt(map: YamlValue, key: string): string | undefined {
  const value = map.entries.find((entry) => entry.key === key)?.value;
  return value?.kind === 'scalar' ? value.text : undefined;
}
