// The page's side of recording_worker.ts.

import type { Refusal } from './recording';
import type { Look, Moment, Summary } from './recording_look';
import type { Order, Report } from './recording_worker';

/** Anything that ends a reading without a summary. */
export type NotRead = { refusal: Refusal } | { failed: string };

type Question = { open: Blob } | { look: Look };

export class RecordingReader {
  private worker: Worker | null = null;
  private order = 0;
  private readonly waiting = new Map<number, (report: Report) => void>();

  /** Another file takes the place of this one, also while it is read. */
  async open(file: Blob): Promise<Summary | NotRead> {
    this.close();
    const worker = new Worker('recording_worker.js', { type: 'module' });
    worker.onmessage = (message: MessageEvent<Report>) => this.waiting.get(message.data.order)?.(message.data);
    worker.onerror = (event) => {
      event.preventDefault();
      this.end(event.message);
    };
    this.worker = worker;
    const report = await this.ask({ open: file });
    if ('summary' in report) return report.summary;
    return 'refusal' in report ? { refusal: report.refusal } : { failed: 'failed' in report ? report.failed : '' };
  }

  /** Null: another file was opened meanwhile, or it cannot be read. */
  async look(look: Look): Promise<Moment | null> {
    const report = await this.ask({ look });
    return 'moment' in report ? report.moment : null;
  }

  close(): void {
    this.end('');
  }

  private end(failed: string): void {
    this.worker?.terminate();
    this.worker = null;
    for (const [order, done] of [...this.waiting]) done({ order, failed });
  }

  private ask(question: Question): Promise<Report> {
    const order = ++this.order;
    return new Promise((resolve) => {
      if (this.worker === null) return resolve({ order, failed: '' });
      this.waiting.set(order, (report) => {
        this.waiting.delete(order);
        resolve(report);
      });
      const message: Order = { order, ...question };
      this.worker.postMessage(message);
    });
  }
}
