import { useEffect, useState } from 'preact/hooks';

/** A number that may be left out: null, and `otherwise` tells what counts then. */
export function OptionalField(props: {
  label: string;
  value: number | null;
  otherwise: string;
  required?: boolean;
  disabled?: boolean;
  onValue: (value: number | null) => void;
}) {
  const shown = props.value === null ? '' : String(props.value);
  const [text, setText] = useState(shown);
  useEffect(() => {
    if (text.trim() === '' ? props.value !== null : Number(text) !== props.value) setText(shown);
  }, [props.value]);
  return (
    <input
      type="number"
      step="any"
      aria-label={props.label}
      placeholder={props.otherwise}
      required={props.required}
      value={text}
      disabled={props.disabled}
      onInput={(event) => {
        setText(event.currentTarget.value);
        const value = event.currentTarget.valueAsNumber;
        props.onValue(Number.isFinite(value) ? value : null);
      }}
    />
  );
}

/** A number that a person types: pictures of the robot that are drawn meanwhile leave the text as it is. */
export function NumberField(props: {
  id?: string;
  label?: string;
  value: number;
  least?: number | undefined;
  changed?: boolean;
  disabled?: boolean;
  onValue: (value: number) => void;
}) {
  const [text, setText] = useState(String(props.value));
  useEffect(() => {
    if (Number(text) !== props.value || text.trim() === '') setText(String(props.value));
  }, [props.value]);
  return (
    <input
      id={props.id}
      type="number"
      step="any"
      min={props.least}
      aria-label={props.label}
      class={props.changed === true ? 'changed' : ''}
      value={text}
      disabled={props.disabled}
      onInput={(event) => {
        setText(event.currentTarget.value);
        const value = event.currentTarget.valueAsNumber;
        if (Number.isFinite(value)) props.onValue(value);
      }}
      onBlur={() => setText(String(props.value))}
    />
  );
}
