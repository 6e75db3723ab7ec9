// Part "Black box": a recording of rc10d, from the robot's computer or dropped, moment by moment.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';

import { MomentTables } from './blackbox_moment';
import { RecordedPlot } from './blackbox_plot';
import { useKnown, useStored, useStudio } from './context';
import { FileButton } from './file_button';
import { number } from './numbers';
import type { RecordingFile } from './protocol';
import type { Moment, Summary } from './recording_look';
import { type Place, period_us, usePlace, within } from './recording_place';
import { RecordingReader } from './recording_reader';
import { damageText, notReadText } from './recording_told';
import { RecordedWordBook } from './recorded_words';
import { SignalChooser } from './signal_chooser';

/** A recording and the place in it, also while another part of the page is shown. */
interface Opened {
  name: string;
  summary: Summary;
  from_us: number;
  to_us: number;
  at_us: number;
}
const kReader = new RecordingReader();
const kLast: { opened: Opened | null } = { opened: null };

function useOpened(): [Opened | null, (opened: Opened | null) => void] {
  const [opened, set] = useState(kLast.opened);
  return [
    opened,
    (next) => {
      kLast.opened = next;
      set(next);
    },
  ];
}

const kKinds = ['frame', 'command', 'setpoint', 'signals', 'order', 'event', 'motor'] as const;

function clock(wall_us: number): string {
  if (!(wall_us > 0 && wall_us < 8.64e21)) return '–';
  const time = new Date(wall_us / 1000);
  return `${time.toLocaleDateString()} ${time.toLocaleTimeString(undefined, { hour12: false })}.${String(time.getMilliseconds()).padStart(3, '0')}`;
}

function SummaryCard(props: { name: string; summary: Summary }) {
  const { word } = useStudio();
  const { summary } = props;
  const ending = summary.cause === 'crash' ? word('boxCrashed') : summary.cause !== '' ? `${word('boxCopy')} ${summary.cause}` : word(summary.ended ? 'boxEnded' : 'boxOpenEnd');
  return (
    <section class="card recording" aria-label={word('boxRecorded')}>
      <h3>{props.name}</h3>
      <p>
        {`${summary.robot} · rc10d ${summary.version} · ${summary.rate_hz} Hz · ${ending}`}
        {summary.simulated && <span class="badge">{word('simulated')}</span>}
      </p>
      <p class="hint">{`${clock(summary.first_wall_us)} + ${number(summary.last_us / 1e6, 3)} s · ${kKinds.map((kind) => `${kind} ${summary.counts[kind] ?? 0}`).join(' · ')}`}</p>
      {summary.dropped > 0 && <p class="hint">{`${summary.dropped} ${word('boxDropped')}`}</p>}
      {summary.damageCount > 0 && (
        <div class="damages" role="alert">
          {summary.damages.map((damage, i) => (
            <p key={i}>{damageText(damage, word)}</p>
          ))}
          {summary.damageCount > summary.damages.length && <p>{`+ ${summary.damageCount - summary.damages.length}`}</p>}
        </div>
      )}
    </section>
  );
}

/** The newest wish is carried out, those that it overtook are not. */
function useMoment(opened: Opened | null, signals: string[], filter: string, problems: boolean, columns: number): Moment | null {
  const [moment, setMoment] = useState<Moment | null>(null);
  const wanted = useRef<(() => Promise<void>) | null>(null);
  const busy = useRef(false);
  useEffect(() => {
    if (opened === null) return setMoment(null);
    const { from_us, to_us, at_us } = opened;
    wanted.current = async () => {
      const found = await kReader.look({ from_us, to_us, at_us, columns, signals, filter, problems });
      if (found !== null) setMoment(found);
    };
    if (busy.current) return;
    busy.current = true;
    void (async () => {
      for (let next = wanted.current; next !== null; next = wanted.current) {
        wanted.current = null;
        await next();
      }
      busy.current = false;
    })();
  }, [opened, signals.join(' '), filter, problems, columns]);
  return opened === null ? null : moment;
}

function Scrubber(props: { opened: Opened; moment: Moment | null; place: Place }) {
  const { word } = useStudio();
  const { opened, moment } = props;
  const { step, to } = props.place;
  const { summary } = opened;
  const tick_us = period_us(summary);
  const told = `${number(opened.at_us / 1e6, 3)} s`;
  return (
    <div class="toolbar scrubber">
      <button type="button" aria-label={word('boxEventBefore')} title={word('boxEventBefore')} disabled={moment === null || moment.before_us === null} onClick={() => step('before_us')}>
        |◀
      </button>
      <button type="button" aria-label={word('boxTickBack')} title={word('boxTickBack')} onClick={() => step('tick_before_us')}>
        ◀
      </button>
      <input
        type="range"
        aria-label={word('boxMoment')}
        aria-valuetext={told}
        min={summary.phase_us / 1e6}
        max={Math.max(summary.phase_us, summary.last_us) / 1e6}
        step={tick_us / 1e6}
        value={opened.at_us / 1e6}
        onInput={(event) => to(within(summary, Number(event.currentTarget.value) * 1e6))}
      />
      <button type="button" aria-label={word('boxTickOn')} title={word('boxTickOn')} onClick={() => step('tick_after_us')}>
        ▶
      </button>
      <button type="button" aria-label={word('boxEventAfter')} title={word('boxEventAfter')} disabled={moment === null || moment.after_us === null} onClick={() => step('after_us')}>
        ▶|
      </button>
      <span class="number">{told}</span>
      <span class="number tick">{`${word('boxTick')} ${moment === null || moment.tick === null ? '–' : moment.tick}`}</span>
      <span class="hint">{moment === null ? '' : clock(moment.wall_us)}</span>
    </div>
  );
}

/** Recordings of the robot's computer, the live one first. */
function OnRobot(props: { onLoad: (file: RecordingFile) => void; busy: boolean }) {
  const { link, word } = useStudio();
  const known = useKnown();
  const [files, setFiles] = useState<RecordingFile[]>([]);
  const [chosen, setChosen] = useState('');
  const list = () => {
    void link.recordings().then((found) => setFiles(found ?? []));
  };
  useEffect(list, [known.hello, known.robot]);
  const file = files.find((each) => each.name === chosen) ?? files[0];
  return (
    <>
      <label>
        {`${word('boxOnRobot')} `}
        <select value={file?.name ?? ''} onFocus={list} onChange={(event) => setChosen(event.currentTarget.value)}>
          {files.length === 0 && <option value="">{word('none')}</option>}
          {files.map((each) => (
            <option key={each.name} value={each.name}>
              {each.live ? `${each.name} (${word('boxLive')})` : each.name}
            </option>
          ))}
        </select>
      </label>
      <button type="button" class="strong" disabled={file === undefined || props.busy} onClick={() => file !== undefined && props.onLoad(file)}>
        {word('boxLoad')}
      </button>
    </>
  );
}

export function BlackBox() {
  const { link, word } = useStudio();
  const [opened, setOpened] = useOpened();
  const [told, setTold] = useState('');
  const [share, setShare] = useState<number | null>(null);
  const [stored, setChosen] = useStored<string[]>('box.signals', []);
  const [filter, setFilter] = useState('');
  const [problems, setProblems] = useState(false);
  const [columns, setColumns] = useState(800);
  const reading = useRef(0);

  const summary = opened?.summary ?? null;
  const all = useMemo(() => new Set(summary?.signals.flatMap((owner) => owner.names) ?? []), [summary]);
  const known = stored.filter((name) => all.has(name));
  const first = summary?.signals[0]?.names.filter((name) => /\.(velocity_rpm|current_a)$/.test(name)) ?? [];
  const chosen = known.length === 0 ? first : known;
  const book = useMemo(() => new RecordedWordBook(link, summary?.models ?? []), [link, summary]);
  const moment = useMoment(opened, chosen, filter, problems, columns);

  const open = async (name: string, file: Blob) => {
    const mine = ++reading.current;
    setOpened(null);
    setTold('');
    setShare(1);
    const result = await kReader.open(file);
    if (mine !== reading.current) return;
    setShare(null);
    if (!('signals' in result)) return setTold(`${name}: ${notReadText(result, word)}`);
    setOpened({ name, summary: result, from_us: 0, to_us: Math.max(1000, result.last_us), at_us: result.last_us });
  };
  const load = async (file: RecordingFile) => {
    const mine = ++reading.current;
    setTold('');
    setShare(0);
    const bytes = await link.recording(file.name, (part) => mine === reading.current && setShare(part));
    if (mine !== reading.current) return;
    if (typeof bytes !== 'string') return open(file.name, new Blob([bytes]));
    setShare(null);
    setTold(bytes);
  };
  const latest = useRef(open);
  latest.current = open;
  // Anywhere on the page: a browser would leave the page for a file that falls beside.
  useEffect(() => {
    const over = (event: DragEvent) => event.preventDefault();
    const drop = (event: DragEvent) => {
      event.preventDefault();
      const file = event.dataTransfer?.files[0];
      if (file !== undefined) void latest.current(file.name, file);
    };
    window.addEventListener('dragover', over);
    window.addEventListener('drop', drop);
    return () => {
      window.removeEventListener('dragover', over);
      window.removeEventListener('drop', drop);
    };
  }, []);

  const place = usePlace(opened, moment, (at_us) => opened !== null && setOpened({ ...opened, at_us }));
  const show = (from_us: number, to_us: number) => opened !== null && setOpened({ ...opened, from_us, to_us });

  return (
    <>
      <div class="toolbar">
        <OnRobot busy={share !== null} onLoad={(file) => void load(file)} />
        <FileButton text={word('boxOpen')} accept=".blackbox,.crashed" onFile={(file) => void open(file.name, file)} />
        <span class="hint reading" role="status">
          {share === null ? '' : `${word('boxReading')} ${share < 1 ? `${number(100 * share, 0)} %` : ''}`}
        </span>
      </div>
      {told !== '' && (
        <p class="refused" role="alert">
          {told}
        </p>
      )}
      {opened === null && <p class="hint dropzone">{word('boxHint')}</p>}
      {opened !== null && (
        <>
          <SummaryCard name={opened.name} summary={opened.summary} />
          <Scrubber opened={opened} moment={moment} place={place} />
          <div class="plots">
            <SignalChooser owners={opened.summary.signals} chosen={chosen} onChoose={setChosen} />
            <RecordedPlot
              signals={chosen}
              moment={moment}
              from_us={opened.from_us}
              to_us={opened.to_us}
              at_us={opened.at_us}
              whole={opened.from_us === 0 && opened.to_us >= opened.summary.last_us}
              onAt={place.to}
              onShow={show}
              onWhole={() => show(0, Math.max(1000, opened.summary.last_us))}
              onColumns={setColumns}
            />
          </div>
          {moment !== null && (
            <MomentTables
              moment={moment}
              book={book}
              filter={filter}
              onFilter={setFilter}
              problems={problems}
              onProblems={setProblems}
              onAt={place.to}
            />
          )}
        </>
      )}
    </>
  );
}
