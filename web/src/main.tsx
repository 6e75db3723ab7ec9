import { render } from 'preact';
import { useEffect, useMemo, useState } from 'preact/hooks';

import { BlackBox } from './blackbox';
import { Commission } from './commission';
import { Configuration } from './config';
import { StudioContext, useKnown, useStored, useStudio } from './context';
import { DownNotice } from './down';
import { Events } from './events';
import { Link } from './link';
import { Match } from './match';
import { Move } from './move';
import { Overview } from './overview';
import { Plots } from './plots';
import { Stop } from './stop';
import { Timing } from './timing';
import { Tune } from './tune';
import { type Language, storeLanguage, storedLanguage, wordsOf } from './words';

const kParts = {
  overview: Overview, match: Match, plots: Plots, commission: Commission, move: Move, tune: Tune, events: Events, blackbox: BlackBox, timing: Timing,
  configuration: Configuration,
} as const;
type Part = keyof typeof kParts;

function Header(props: { language: Language; onLanguage: (language: Language) => void }) {
  const { word } = useStudio();
  const known = useKnown();
  const data = known.state?.data;
  const { connection } = known;
  return (
    <header class="top">
      <h1>{known.robot?.robot.robot ?? 'rc10'}</h1>
      <span class={`badge connection ${connection}`} role="status">
        {word(connection)}
      </span>
      {data !== undefined && <span class={`badge robot ${data.state.toLowerCase()}`}>{data.state}</span>}
      {data !== undefined && data.state !== 'RUN' && (
        <span class="cause">{`${data.stop_cause}${data.stopped_by === '' ? '' : ` (${data.stopped_by})`}`}</span>
      )}
      {data?.conditions.includes('simulated') === true && <span class="badge">{word('simulated')}</span>}
      {data?.conditions.includes('input-open') === true && <span class="badge limit">{word('inputOpen')}</span>}
      {data?.conditions.includes('reduced') === true && <span class="badge limit">{word('reducedSpeed')}</span>}
      {data?.conditions.includes('tuning-locked') === true && <span class="badge">{word('tuningLocked')}</span>}
      {data !== undefined && !data.realtime && <span class="badge">{word('notRealtime')}</span>}
      <span class="grow" />
      <button
        type="button"
        class="language"
        onClick={() => props.onLanguage(props.language === 'en' ? 'zh' : 'en')}
      >
        {word('language')}
      </button>
      <Stop />
    </header>
  );
}

function Body() {
  const { link, word } = useStudio();
  const known = useKnown();
  const [part, setPart] = useStored<Part>('part', 'overview');
  const [token, setToken] = useState('');
  if (known.hello?.right === 'nothing') {
    return (
      <form
        class="token"
        onSubmit={(event) => {
          event.preventDefault();
          link.showToken(token);
        }}
      >
        <p>{word('tokenNeeded')}</p>
        <label>
          {word('token')} <input value={token} onInput={(event) => setToken(event.currentTarget.value)} autocomplete="off" />
        </label>
        <button type="submit">{word('show')}</button>
        {known.tokenRefused && (
          <p class="refused" role="alert">
            {word('tokenWrong')}
          </p>
        )}
      </form>
    );
  }
  const Shown = kParts[part] ?? Overview;
  return (
    <>
      <nav role="tablist">
        {(Object.keys(kParts) as Part[]).map((name) => (
          <button
            type="button"
            key={name}
            role="tab"
            id={`tab-${name}`}
            aria-selected={part === name}
            aria-controls="part"
            onClick={() => setPart(name)}
          >
            {word(name)}
          </button>
        ))}
      </nav>
      {known.down !== null && <DownNotice down={known.down} />}
      <main id="part" role="tabpanel" aria-labelledby={`tab-${part}`}>
        <Shown />
      </main>
    </>
  );
}

function Page() {
  const [language, setLanguage] = useState<Language>(storedLanguage);
  const link = useMemo(() => new Link(), []);
  const studio = useMemo(() => ({ link, word: wordsOf(language), language }), [link, language]);
  useEffect(() => link.connect(), [link]);
  useEffect(() => storeLanguage(language), [language]);
  // A phone is felt, too.
  useEffect(() => {
    let faults = 0;
    return link.subscribe(() => {
      const now = link.known.state?.data.motors.filter((motor) => motor.status === 'FAULT').length ?? 0;
      if (now > faults) navigator.vibrate?.([200, 100, 200]);
      faults = now;
    });
  }, [link]);
  return (
    <StudioContext.Provider value={studio}>
      <Header language={language} onLanguage={setLanguage} />
      <Body />
      <footer class="bottom">{studio.word('noSafety')}</footer>
    </StudioContext.Provider>
  );
}

const root = document.getElementById('studio');
if (root !== null) render(<Page />, root);
