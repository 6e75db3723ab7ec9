// The choice of signals, by motor and module.
import { useState } from 'preact/hooks';

import { useStudio } from './context';

const kMostSignals = 12;

export interface SignalsOf {
  owner: string;
  names: string[];
}

export function SignalChooser(props: { owners: SignalsOf[]; chosen: string[]; onChoose: (names: string[]) => void }) {
  const { word } = useStudio();
  const [filter, setFilter] = useState('');
  const toggle = (name: string) =>
    props.onChoose(
      props.chosen.includes(name) ? props.chosen.filter((n) => n !== name) : [...props.chosen, name],
    );
  return (
    <details class="chooser" open>
      <summary>{`${word('signals')} (${props.chosen.length})`}</summary>
      <input
        type="search"
        placeholder="velocity"
        aria-label={word('choose')}
        value={filter}
        onInput={(event) => setFilter(event.currentTarget.value)}
      />
      {props.owners.map(({ owner, names }) => {
        const shown = names.filter((name) => name.includes(filter) || props.chosen.includes(name));
        if (shown.length === 0) return null;
        return (
          <fieldset key={owner}>
            <legend>{owner}</legend>
            {shown.map((name) => (
              <label key={name}>
                <input
                  type="checkbox"
                  checked={props.chosen.includes(name)}
                  disabled={!props.chosen.includes(name) && props.chosen.length >= kMostSignals}
                  onChange={() => toggle(name)}
                />
                {name.slice(owner.length + 1)}
              </label>
            ))}
          </fieldset>
        );
      })}
    </details>
  );
}
