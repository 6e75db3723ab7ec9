// Part "Configuration": the robot's file in an editor, with what rc10d would say to it.
import { useEffect, useRef, useState } from 'preact/hooks';

import { type Draft, kDraft, plain } from './config_draft';
import type { ConfigEditor } from './config_editor';
import { CheckedTables } from './config_tables';
import { type ConfigSchema, type KeyHelp, loadSchema } from './config_schema';
import { useStudio } from './context';
import { download } from './download';
import { FileButton } from './file_button';
import type { CheckedConfig, ConfigFile, ConfigProblem, Response } from './protocol';
import type { Word } from './words';

type Checked = CheckedConfig['checked'];
type Robot = NonNullable<Checked['robot']>;

const kPauseMs = 250;
const kMostBytes = 128 * 1024;
const kSources: Record<ConfigFile['of'], Word> = { running: 'configRunning', last: 'configLast', refused: 'configRefused' };
const kEditor = '/editor.js';

function bytesOf(text: string): number {
  return new TextEncoder().encode(text).length;
}

/** Verdict of rc10d on the text, soon after it has changed, and on a new connection; of the newest text, no other. */
function useChecked(text: string): { checked: Checked | null; robot: Robot | null; why: string; busy: boolean } {
  const { link, word } = useStudio();
  const [checked, setChecked] = useState<Checked | null>(null);
  const [robot, setRobot] = useState<Robot | null>(null);
  const [why, setWhy] = useState('');
  const [busy, setBusy] = useState(false);
  const wanted = useRef<string | null>(null);
  const asking = useRef(false);
  // This alone of what is known: each state would draw all of this part anew.
  const [hello, setHello] = useState(link.known.hello);
  useEffect(() => link.subscribe(() => setHello(link.known.hello)), [link]);

  useEffect(() => {
    wanted.current = text === '' ? null : text;
    setBusy(text !== '');
    if (text === '') {
      setWhy('');
      return setChecked(null);
    }
    const timer = setTimeout(async () => {
      if (asking.current) return;
      asking.current = true;
      while (wanted.current !== null) {
        const next: string = wanted.current;
        const answer = bytesOf(next) > kMostBytes ? word('configTooLarge') : await link.checkConfig(next);
        // The lines of a text that has changed since are others, and an empty one has none.
        if (wanted.current !== next) continue;
        wanted.current = null;
        setWhy(typeof answer === 'string' ? answer : '');
        setChecked(typeof answer === 'string' ? null : answer.checked);
        if (typeof answer !== 'string' && answer.checked.robot !== null) setRobot(answer.checked.robot);
        setBusy(false);
      }
      asking.current = false;
    }, kPauseMs);
    return () => clearTimeout(timer);
  }, [text, link, hello]);
  return { checked, robot, why, busy };
}

function Verdict(props: { checked: Checked | null; why: string; busy: boolean }) {
  const { word } = useStudio();
  const { checked, why, busy } = props;
  let words = busy ? word('configChecking') : word('configUnknown');
  let look = '';
  if (!busy && checked !== null) {
    const { errors, warnings } = checked;
    words = errors.length === 0 ? word('configGood') : `${word('errors')}: ${errors.length}`;
    if (warnings.length > 0) words += ` · ${word('configWarnings')}: ${warnings.length}`;
    look = errors.length > 0 ? 'error' : warnings.length > 0 ? 'warning' : 'live';
  }
  return (
    <>
      <span class={`badge verdict-badge ${look}`} role="status">
        {words}
      </span>
      {!busy && why !== '' && <span class="refused">{why}</span>}
    </>
  );
}

function Problems(props: { checked: Checked; onGo: (problem: ConfigProblem) => void }) {
  const { word } = useStudio();
  const { errors, warnings } = props.checked;
  const all = [
    ...errors.map((problem) => ({ problem, severity: 'error' })),
    ...warnings.map((problem) => ({ problem, severity: 'warning' })),
  ].sort((a, b) => a.problem.line - b.problem.line || a.problem.column - b.problem.column);
  if (all.length === 0) return null;
  return (
    <section class="card config-problems" aria-label={word('configProblems')}>
      <ul>
        {all.map(({ problem, severity }, i) => (
          <li key={i} class={severity}>
            <button type="button" class="when" onClick={() => props.onGo(problem)}>
              {problem.line === 0 ? word('configWhole') : `${problem.line}:${problem.column}`}
            </button>
            <span class={`badge ${severity}`}>{severity}</span> {problem.path !== '' && <code>{problem.path}</code>} {problem.text}
          </li>
        ))}
      </ul>
    </section>
  );
}

function range(help: KeyHelp): string {
  if (help.words.length > 0) return help.words.join(' | ');
  if (help.least !== null && help.most !== null) return `${help.least} … ${help.most}`;
  if (help.least !== null) return `≥ ${help.least}`;
  return help.most === null ? '' : `≤ ${help.most}`;
}

function HelpCard(props: { help: KeyHelp | null; about: string }) {
  const { word } = useStudio();
  const { help, about } = props;
  return (
    <section class="card config-help" aria-label={word('configHelp')}>
      {help === null ? (
        <p class="hint">{about === '' ? word('configHelpNone') : about}</p>
      ) : (
        <>
          <h3>
            <code>{help.key}</code>
          </h3>
          <p lang="en">{help.about}</p>
          <p class="hint">
            {[
              range(help) === '' ? '' : `${word('configValues')}: ${range(help)}`,
              help.initial === null ? '' : `${word('configDefault')}: ${help.initial}`,
              help.required ? word('configRequired') : '',
            ]
              .filter((each) => each !== '')
              .join(' · ')}
          </p>
        </>
      )}
    </section>
  );
}

async function sha256Of(text: string): Promise<string> {
  // A page on loopback has it, which alone may install.
  if (!window.isSecureContext) return '';
  const bytes = await crypto.subtle.digest('SHA-256', new TextEncoder().encode(text));
  return Array.from(new Uint8Array(bytes), (byte) => byte.toString(16).padStart(2, '0')).join('');
}

/** By the root helper, where the robot allows it. */
function OnRobot(props: { draft: Draft; sound: boolean; onInstalled: (text: string, sha256: string) => void }) {
  const { link, word } = useStudio();
  const { draft, sound, onInstalled } = props;
  const [told, setTold] = useState<Response | null>(null);
  const [busy, setBusy] = useState(false);
  const ask = async (message: Parameters<typeof link.changeFile>[0]) => {
    setBusy(true);
    setTold(null);
    const answer = await link.changeFile(message);
    setTold(answer);
    setBusy(false);
    if (answer.status === 'ok' && message.type === 'config_install') onInstalled(message.text, await sha256Of(message.text));
  };
  return (
    <>
      <div class="toolbar">
        <button
          type="button"
          disabled={busy || !sound || draft.hidden > 0}
          onClick={() => void ask({ type: 'config_install', text: draft.text, replaces: draft.replaces })}
        >
          {word('configInstallNow')}
        </button>
        <button type="button" disabled={busy} onClick={() => void ask({ type: 'config_restart' })}>
          {word('configRestart')}
        </button>
      </div>
      {told !== null && (
        <p class={told.status === 'ok' ? 'notice' : 'refused'} role={told.status === 'ok' ? 'status' : 'alert'} lang="en">
          {told.message}
        </p>
      )}
    </>
  );
}

function Install(props: { draft: Draft; sound: boolean; onInstalled: (text: string, sha256: string) => void }) {
  const { word } = useStudio();
  return (
    <details class="notes">
      <summary>{word('configInstall')}</summary>
      <p>{word('configInstallHelper')}</p>
      <OnRobot {...props} />
      <p>{word('configInstallHint')}</p>
      <pre tabIndex={0} aria-label={word('configInstall')}>
        {'rc10d --check robot.yaml\nsudo install -m 644 --backup=numbered robot.yaml /etc/rc10d/robot.yaml\nsudo systemctl restart rc10d'}
      </pre>
      <p>{word('configInstallStop')}</p>
    </details>
  );
}

export function Configuration() {
  const { link, word } = useStudio();
  const [draft, setDraft] = useState<Draft>(kDraft);
  const [told, setTold] = useState('');
  const [help, setHelp] = useState<{ key: KeyHelp | null; about: string }>({ key: null, about: '' });
  const place = useRef<HTMLDivElement>(null);
  const editor = useRef<ConfigEditor | null>(null);
  const [ready, setReady] = useState(false);
  const known = useRef<ConfigSchema | null>(null);
  const { checked, robot, why, busy } = useChecked(draft.text);

  const change = (next: Partial<Draft>) => setDraft({ ...Object.assign(kDraft, next) });

  const load = (file: string, from: string, hidden: number, replaces = '') => {
    const text = plain(file);
    setTold('');
    // The editor tells of its text itself.
    change({ loaded: text, text, from, hidden, replaces });
    if (editor.current !== null && editor.current.text() !== text) editor.current.replace(text);
  };
  const loadRobots = async () => {
    const answer = await link.config();
    if (typeof answer === 'string') return setTold(answer);
    if (answer.config.why !== '') return setTold(answer.config.why);
    load(answer.config.text, word(kSources[answer.of]), answer.config.hidden, answer.sha256);
  };
  const loadTemplate = async () => {
    try {
      const answer = await fetch('/template.yaml');
      if (!answer.ok) throw new Error(`${answer.status} ${answer.statusText}`);
      load(await answer.text(), word('configTemplate'), 0);
    } catch (error) {
      setTold(`${word('configNoTemplate')} ${String(error)}`);
    }
  };
  const loadFile = async (file: File | null | undefined) => {
    if (file === null || file === undefined) return;
    if (file.size > kMostBytes) return setTold(word('configTooLarge'));
    load(await file.text(), file.name, 0);
  };

  useEffect(() => {
    let gone = false;
    void loadSchema().then((found) => {
      known.current = found;
    });
    void (import(kEditor) as Promise<typeof import('./config_editor')>)
      .then(({ makeEditor }) => {
        if (gone || place.current === null) return;
        editor.current = makeEditor({
          parent: place.current,
          text: kDraft.text,
          label: word('configText'),
          onText: (text) => change({ text }),
          onCursor: (text, at) => {
            const found = known.current?.help(text, at);
            setHelp({ key: found?.key ?? null, about: found?.about ?? '' });
          },
          suggest: (text, at) => known.current?.help(text, at) ?? { from: at, suggestions: [] },
        });
        setReady(true);
        if (kDraft.from === '' && kDraft.text === '') void loadRobots();
      })
      .catch((error: unknown) => setTold(`${word('configNoEditor')} ${String(error)}`));
    return () => {
      gone = true;
      editor.current?.close();
      editor.current = null;
    };
  }, []);

  useEffect(() => {
    if (!ready || busy) return;
    const marks = (severity: 'error' | 'warning') => (problem: ConfigProblem) => ({
      line: problem.line,
      column: problem.column,
      text: problem.path === '' ? problem.text : `${problem.path}: ${problem.text}`,
      severity,
    });
    editor.current?.mark([...(checked?.errors ?? []).map(marks('error')), ...(checked?.warnings ?? []).map(marks('warning'))]);
  }, [ready, busy, checked]);

  return (
    <div
      onDragOver={(event) => event.preventDefault()}
      onDrop={(event) => {
        event.preventDefault();
        void loadFile(event.dataTransfer?.files[0]);
      }}
    >
      <div class="toolbar">
        <button type="button" onClick={() => void loadRobots()}>
          {word('configRobot')}
        </button>
        <button type="button" onClick={() => void loadTemplate()}>
          {word('configTemplate')}
        </button>
        <FileButton text={word('configOpen')} accept=".yaml,.yml" onFile={(file) => void loadFile(file)} />
        <button type="button" disabled={draft.text === ''} onClick={() => download(`${robot?.name ?? 'robot'}.yaml`, new Blob([draft.text], { type: 'application/yaml' }))}>
          {word('configDownload')}
        </button>
        <span class="hint">{draft.from}</span>
        {draft.text !== draft.loaded && <span class="badge">{word('configChanged')}</span>}
        <Verdict checked={checked} why={why} busy={busy} />
      </div>
      {told !== '' && (
        <p class="refused" role="alert">
          {told}
        </p>
      )}
      {draft.hidden > 0 && <p class="notice">{word('configHidden')}</p>}
      <div class="config">
        <div class="config-editor" ref={place} />
        <div class="config-side">
          <HelpCard help={help.key} about={help.about} />
          {checked !== null && !busy && <Problems checked={checked} onGo={(problem) => editor.current?.goTo(problem.line, problem.column)} />}
        </div>
      </div>
      {robot !== null && <CheckedTables robot={robot} old={checked === null || checked.robot === null} />}
      <Install
        draft={draft}
        sound={checked !== null && !busy && checked.errors.length === 0}
        onInstalled={(text, sha256) => change({ loaded: text, replaces: sha256 })}
      />
    </div>
  );
}
