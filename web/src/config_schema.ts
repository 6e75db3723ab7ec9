// The JSON schema of the configuration: what a key means at its place, and which keys and values there may be.
import { fetchedOnce } from './fetched_once';
import { type Place, type YamlValue, placeIn, textAt } from './yaml_places';

type Word = string | number | boolean;

/** The part of JSON schema that `rc10d --schema` writes. */
export interface Schema {
  $ref?: string;
  $defs?: Record<string, Schema>;
  description?: string;
  type?: string;
  enum?: Word[];
  const?: Word;
  default?: Word;
  minimum?: number;
  exclusiveMinimum?: number;
  maximum?: number;
  required?: string[];
  properties?: Record<string, Schema | false>;
  additionalProperties?: Schema | false;
  items?: Schema;
  oneOf?: Schema[];
  allOf?: Schema[];
  if?: Schema;
  then?: Schema;
  else?: Schema;
}

export interface KeyHelp {
  key: string;
  about: string;
  words: Word[];
  least: number | null;
  most: number | null;
  initial: Word | null;
  required: boolean;
  /** "number", "string", "boolean", "object", "array" */
  kind: string;
}

export interface Suggestion {
  label: string;
  about: string;
  isKey: boolean;
}

export interface Help {
  /** The key under the cursor. */
  key: KeyHelp | null;
  /** Words of the section, and its keys that are not there yet. */
  about: string;
  from: number;
  suggestions: Suggestion[];
}

type Section = { about: string; keys: Map<string, KeyHelp> };

export class ConfigSchema {
  constructor(private readonly top: Schema) {}

  help(text: string, cursor: number): Help {
    const { root, place } = placeIn(text, cursor);
    if (place === null) return { key: null, about: '', from: cursor, suggestions: [] };
    const section = this.section(place.map, root);
    const key = place.entry === null ? null : (section?.keys.get(place.entry.key) ?? null);
    return { key, about: section?.about ?? '', from: place.from, suggestions: suggestionsOf(section, key, place) };
  }

  /** Keys of a motor of this model. */
  keysOf(model: string): string[] {
    const text = `buses: [{type: sim, motors: [{model: ${model}, }]}]`;
    return this.help(text, text.indexOf(', }') + 2).suggestions.map((each) => each.label);
  }

  private found(schema: Schema | false | undefined): Schema | null {
    if (schema === undefined || schema === false) return null;
    const name = schema.$ref?.replace('#/$defs/', '');
    return name === undefined ? schema : (this.top.$defs?.[name] ?? null);
  }

  /** The schema of a map, by the way from the top. */
  private schemaOf(map: YamlValue, root: YamlValue): Schema | null {
    if (map.parent === null) return this.found(this.top);
    const above = map.parent;
    if (above.kind === 'list') {
      const list = above.parent === null ? null : this.schemaOfKey(above.parent, above.key, root);
      const items = list?.items;
      if (items?.oneOf !== undefined) return this.variant(items.oneOf, textAt(map, 'type'));
      return this.found(items);
    }
    const schema = this.schemaOfKey(above, map.key, root);
    return schema;
  }

  private schemaOfKey(map: YamlValue, key: string, root: YamlValue): Schema | null {
    const schema = this.schemaOf(map, root);
    if (schema === null) return null;
    const own = schema.properties?.[key];
    if (own === undefined) return this.found(schema.additionalProperties);
    return this.found(own);
  }

  /** The type of a list's item that is named; without a name: what all types have in common. */
  private variant(all: Schema[], type: string | undefined): Schema | null {
    const schemas = all.map((each) => this.found(each)).filter((each) => each !== null);
    const types = (schema: Schema) => {
      const of = schema.properties?.['type'];
      return of === undefined || of === false ? [] : (of.enum ?? []);
    };
    const found = schemas.find((schema) => types(schema).some((word) => word === type));
    if (found !== undefined) return found;
    const first = schemas[0];
    const of = first?.properties?.['type'];
    if (of === undefined || of === false) return null;
    return { required: ['type'], properties: { type: { ...of, enum: schemas.flatMap(types) } } };
  }

  private section(map: YamlValue, root: YamlValue): Section | null {
    const schema = this.schemaOf(map, root);
    if (schema === null) return null;
    const values = (name: string) => {
      const own = textAt(map, name);
      if (own !== undefined) return own;
      const profile = textAt(map, 'profile');
      const profiles = root.entries.find((entry) => entry.key === 'profiles')?.value;
      const shared = profiles?.entries.find((entry) => entry.key === profile)?.value;
      return shared?.kind === 'map' ? textAt(shared, name) : undefined;
    };
    const keys = new Map<string, Schema>();
    const gone = new Set<string>();
    const required = new Set<string>();
    const take = (part: Schema) => {
      for (const name of part.required ?? []) required.add(name);
      for (const [name, key] of Object.entries(part.properties ?? {})) {
        if (key === false) {
          gone.add(name);
          continue;
        }
        const full = this.found(key);
        if (full !== null) keys.set(name, { ...keys.get(name), ...full, ...key });
      }
    };
    take(schema);
    for (const part of [schema, ...(schema.allOf ?? [])]) {
      if (part.if === undefined) continue;
      const chosen = holds(part.if, values) ? part.then : part.else;
      if (chosen !== undefined) take(chosen);
    }
    for (const name of gone) keys.delete(name);
    return {
      about: schema.description ?? '',
      keys: new Map([...keys].map(([name, key]) => [name, helpOf(name, key, required.has(name))])),
    };
  }
}

/** The schema of the rc10d that runs here. */
export const loadSchema = fetchedOnce('/rc10d.schema.json', (schema) => new ConfigSchema(schema as Schema));

function holds(condition: Schema, values: (name: string) => string | undefined): boolean {
  return Object.entries(condition.properties ?? {}).every(([name, wanted]) => {
    const value = values(name);
    if (value === undefined || wanted === false) return false;
    const words = wanted.const === undefined ? (wanted.enum ?? []) : [wanted.const];
    return words.some((word) => String(word) === value);
  });
}

function wordsOf(schema: Schema): Word[] {
  if (schema.const !== undefined) return [schema.const];
  return schema.enum ?? schema.items?.enum ?? (schema.type === 'boolean' ? [true, false] : []);
}

function helpOf(key: string, schema: Schema, required: boolean): KeyHelp {
  return {
    key,
    about: schema.description ?? '',
    words: wordsOf(schema),
    least: schema.minimum ?? schema.exclusiveMinimum ?? null,
    most: schema.maximum ?? null,
    initial: schema.default ?? null,
    required,
    kind: schema.properties !== undefined ? 'object' : (schema.type ?? 'string'),
  };
}

function suggestionsOf(section: Section | null, key: KeyHelp | null, place: Place): Suggestion[] {
  if (section === null) return [];
  // Within a key nothing is suggested.
  if (place.entry !== null && place.from <= place.entry.to) return [];
  if (place.entry !== null) return (key?.words ?? []).map((word) => ({ label: String(word), about: '', isKey: false }));
  const given = new Set(place.map.entries.map((entry) => entry.key));
  return [...section.keys.values()]
    .filter((each) => !given.has(each.key))
    .map((each) => ({ label: each.key, about: each.about, isKey: true }));
}
