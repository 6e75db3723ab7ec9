// Signals as MCAP, for Foxglove and PlotJuggler. A bundle of its own, loaded when a file is saved.
import { type IWritable, McapWriter } from '@mcap/core';

import type { SignalLog } from './signal_log';

// As many as a value of 32 bits has.
const kDigits = 9;
// Between these many ticks the page draws, and its STOP is heard.
const kTicksAtATime = 2048;

class Pieces implements IWritable {
  readonly pieces: Uint8Array<ArrayBuffer>[] = [];
  private bytes = 0n;

  // The writer uses its buffer again.
  async write(buffer: Uint8Array): Promise<void> {
    this.pieces.push(Uint8Array.from(buffer));
    this.bytes += BigInt(buffer.length);
  }

  position(): bigint {
    return this.bytes;
  }
}

function bytesOf(value: unknown): Uint8Array {
  return new TextEncoder().encode(JSON.stringify(value));
}

/** A topic for each motor and module, its fields are the signals; a message for each tick in which it reports one. */
export async function mcapOf(log: SignalLog): Promise<Blob> {
  const file = new Pieces();
  const writer = new McapWriter({ writable: file });
  await writer.start({ profile: '', library: 'rc10-web' });
  await writer.addMetadata({ name: 'rc10', metadata: new Map(Object.entries(log.about)) });
  const channels: number[] = [];
  for (const { topic, fields } of log.topics) {
    const properties = Object.fromEntries(fields.map(({ name, unit }) => [name, { type: 'number', description: unit }]));
    const schemaId = await writer.registerSchema({
      name: `rc10${topic}`,
      encoding: 'jsonschema',
      data: bytesOf({ type: 'object', properties }),
    });
    const units = new Map(fields.map(({ name, unit }) => [name, unit]));
    channels.push(await writer.registerChannel({ topic, messageEncoding: 'json', schemaId, metadata: units }));
  }
  for (let tick = 0; tick < log.ticks; ++tick) {
    const time_ns = BigInt(Math.max(0, Math.round(log.start_us + tick * log.period_us))) * 1000n;
    for (const [i, { fields }] of log.topics.entries()) {
      const message: Record<string, number> = {};
      for (const { name, values } of fields) {
        const value = values[tick] ?? NaN;
        if (Number.isFinite(value)) message[name] = Number(value.toPrecision(kDigits));
      }
      if (Object.keys(message).length === 0) continue;
      await writer.addMessage({ channelId: channels[i] ?? 0, sequence: tick, logTime: time_ns, publishTime: time_ns, data: bytesOf(message) });
    }
    if (tick % kTicksAtATime === kTicksAtATime - 1) await new Promise((resolve) => setTimeout(resolve));
  }
  await writer.end();
  return new Blob(file.pieces, { type: 'application/octet-stream' });
}
