// Reads recordings in a thread of its own, so that the page, and its STOP, go on whatever a file holds.

import { Recording, RecordingError, type Refusal } from './recording';
import { type RecordingFormat, kFormatPath } from './recording_format';
import { type Look, type Moment, type Summary, momentOf, summaryOf } from './recording_look';

export type Order = { order: number } & ({ open: Blob } | { look: Look });
export type Report = { order: number } & ({ summary: Summary } | { moment: Moment } | { refusal: Refusal } | { failed: string });

interface Thread {
  onmessage: ((message: MessageEvent<Order>) => void) | null;
  postMessage(report: Report): void;
}
const kThread = self as unknown as Thread;

let format: RecordingFormat | null = null;
let recording: Recording | null = null;

async function formatOfServer(): Promise<RecordingFormat> {
  if (format !== null) return format;
  const answer = await fetch(kFormatPath);
  if (!answer.ok) throw new Error(`${kFormatPath}: ${answer.status}`);
  format = (await answer.json()) as RecordingFormat;
  return format;
}

async function open(file: Blob): Promise<Summary> {
  recording = null;
  const known = await formatOfServer();
  // Before it is in memory.
  if (file.size > known.max_file_bytes) throw new RecordingError({ why: 'too_large', found: file.size, most: known.max_file_bytes });
  recording = new Recording(known, new Uint8Array(await file.arrayBuffer()));
  return summaryOf(recording, known);
}

kThread.onmessage = async (message) => {
  const { order } = message.data;
  try {
    if ('open' in message.data) kThread.postMessage({ order, summary: await open(message.data.open) });
    else if (recording !== null && format !== null) kThread.postMessage({ order, moment: momentOf(recording, format, message.data.look) });
    // Each question has an answer: this one was meant for the file before.
    else kThread.postMessage({ order, failed: '' });
  } catch (error) {
    if (error instanceof RecordingError) kThread.postMessage({ order, refusal: error.refusal });
    else kThread.postMessage({ order, failed: String(error) });
  }
};
