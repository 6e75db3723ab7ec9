import type { Link } from './link';

/** rc10-web gives no more columns at a time. */
export const kMostColumns = 4096;
/** An answer is left out when this page reads too slowly: then it is asked for again. */
const kPatienceMs = 2000;
const kTries = 3;

/** Each tick of the past of the signals of this view, piece by piece; NaN: not reported. Null: no answer. */
export function ticksOf(
  link: Link,
  of: { view: number; signals: number; first: number; count: number; period_us: number },
): Promise<Float32Array[] | null> {
  const values = Array.from({ length: of.signals }, () => new Float32Array(of.count));
  let got = 0;
  let tries = 0;
  return new Promise((resolve) => {
    let timer = 0;
    const end = (result: Float32Array[] | null) => {
      clearTimeout(timer);
      forget();
      resolve(result);
    };
    const ask = () => {
      clearTimeout(timer);
      timer = window.setTimeout(() => (++tries < kTries ? ask() : end(null)), kPatienceMs);
      link.range(of.first + got, of.period_us, Math.min(kMostColumns, of.count - got));
    };
    const forget = link.addColumns((received) => {
      if (received.kind !== 'range' || received.view !== of.view || received.columnUs !== of.period_us) return;
      // Other parts of the page ask, too.
      if (received.first !== of.first + got || received.count === 0 || received.count > of.count - got) return;
      // Two ticks in one column, of which one was late: a value that was there, not their mean.
      received.max.forEach((row, i) => values[i]?.set(row, got));
      got += received.count;
      tries = 0;
      if (got < of.count) ask();
      else end(values);
    });
    if (of.count > 0) ask();
    else end(null);
  });
}
