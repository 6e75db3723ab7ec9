// Drives among the sightings of a scan.
import type { Sighting } from './protocol';

export interface HeardDrive {
  kind: string;
  id: number;
  /** Motor of the file that takes its frames; null: none. */
  motor: string | null;
  collides: boolean;
  /** One of several that may have sent these frames. */
  ambiguous: boolean;
  frames: number;
  ids: string[];
  /** Keys of its own that its frames tell. */
  own: Record<string, number>;
}

function idText(sighting: Sighting): string {
  const digits = sighting.frame_id.toString(16).toUpperCase();
  return sighting.extended ? `0x${digits.padStart(8, '0')}` : `0x${digits.padStart(3, '0')}`;
}

// The id of its answers is set in the drive, and a key of the file.
function ownOf(kind: string, sighting: Sighting): Record<string, number> {
  return kind === 'Damiao' ? { master_id: sighting.frame_id } : {};
}

/** Each drive once, those of the file first. Where the file says which of several it is, the others are none. */
export function drivesOf(sightings: Sighting[]): HeardDrive[] {
  const found = new Map<string, HeardDrive>();
  for (const sighting of sightings) {
    const known = sighting.guesses.filter((guess) => guess.motor !== null && !guess.collides);
    for (const guess of sighting.ambiguous && known.length > 0 ? known.slice(0, 1) : sighting.guesses) {
      if (!guess.from_drive) continue;
      const own = ownOf(guess.kind, sighting);
      const key = `${guess.kind} ${guess.id} ${Object.values(own)}`;
      const drive = found.get(key) ?? { kind: guess.kind, id: guess.id, motor: guess.motor, collides: guess.collides, ambiguous: true, frames: 0, ids: [], own };
      drive.ambiguous &&= sighting.ambiguous && known.length === 0;
      drive.frames += sighting.frames;
      drive.ids.push(idText(sighting));
      found.set(key, drive);
    }
  }
  return [...found.values()].sort((a, b) => Number(a.motor === null) - Number(b.motor === null));
}

// Frames tell the kind: its models, or, where there are many, their names. Then the label tells which.
const kModels: Record<string, string[] | RegExp> = {
  'DJI M3508 or M2006': ['M3508', 'M2006'],
  'DJI GM6020': ['GM6020'],
  VESC: ['VESC'],
  moteus: ['moteus'],
  ODrive: ['ODrive_S1', 'ODrive_Pro', 'ODrive_v3'],
  Damiao: /^DM/,
  'RobStride or CyberGear': /^(RS0|EL05|CyberGear)/,
  'CubeMars (servo)': /^AK/,
  'CubeMars (MIT)': /^AK/,
  MyActuator: /^RMD/,
  'LK-Tech': /^LK/,
};

export function modelsOf(kind: string): string[] {
  const models = kModels[kind];
  return Array.isArray(models) ? models : [];
}

export function isOfKind(model: string, kind: string): boolean {
  const models = kModels[kind];
  return Array.isArray(models) ? models.includes(model) : (models?.test(model) ?? false);
}

/** A motor for the file. */
export function motorLine(name: string, model: string, keys: Record<string, number>): string {
  const values = Object.entries(keys).map(([key, value]) => `${key}: ${value}`);
  return `{${[`name: ${name}`, `model: ${model === '' ? '?' : model}`, ...values].join(', ')}}`;
}
