import { useKnown, useStudio } from './context';
import { duration } from './numbers';
import type { Percentiles } from './protocol';

const kParts = ['p50', 'p99', 'p999', 'max'] as const;

function Row(props: { name: string; value: Percentiles; longest: number }) {
  return (
    <tr>
      <th scope="row">{props.name}</th>
      {kParts.map((part) => (
        <td key={part} class="number">
          {duration(props.value[part])}
        </td>
      ))}
      <td class="bars" aria-hidden="true">
        {kParts.map((part) => (
          <div
            key={part}
            class={`bar ${part}`}
            style={{ width: `${Math.min(100, (100 * Math.log1p(props.value[part])) / Math.log1p(props.longest))}%` }}
          />
        ))}
      </td>
    </tr>
  );
}

export function Timing() {
  const { word } = useStudio();
  const data = useKnown().diagnostics?.data;
  if (data === undefined) return <p class="hint">…</p>;
  const rows: [string, Percentiles][] = [
    [word('wake'), data.wake_latency_us],
    [word('tick'), data.tick_duration_us],
    ...Object.entries(data.durations_us).filter(([, value]) => value.count > 0),
  ];
  const longest = Math.max(1, ...rows.map(([, value]) => value.max));
  const counts: [string, number][] = [
    [word('missed'), data.missed_ticks],
    [word('pageFaults'), data.page_faults],
    ...Object.entries(data.counters),
    ...Object.entries(data.refusals)
      .filter(([, count]) => count > 0)
      .map(([name, count]): [string, number] => [`${word('refusals')}: ${name}`, count]),
  ];
  return (
    <>
      {data.notices.map((notice) => (
        <p class="notice" key={notice}>
          {notice}
        </p>
      ))}
      <div class="scroll" role="region" aria-label={word('timing')} tabIndex={0}>
        <table class="timing">
          <thead>
            <tr>
              <th />
              {kParts.map((part) => (
                <th key={part} scope="col">
                  {part === 'p999' ? 'p99.9' : part}
                </th>
              ))}
              <th />
            </tr>
          </thead>
          <tbody>
            {rows.map(([name, value]) => (
              <Row key={name} name={name} value={value} longest={longest} />
            ))}
          </tbody>
        </table>
      </div>
      <div class="cards counts">
        {counts.map(([name, count]) => (
          <div class="value" key={name}>
            <span class="value-name">{name}</span>
            <span class="value-number">{count}</span>
          </div>
        ))}
      </div>
    </>
  );
}
