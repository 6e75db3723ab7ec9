// Copying, also on a page without encryption, where browsers hide their clipboard from scripts.
import type { ComponentChildren } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';

import { useStudio } from './context';

const kCopiedMs = 1500;

async function copyText(text: string): Promise<boolean> {
  if (navigator.clipboard !== undefined) {
    return navigator.clipboard.writeText(text).then(() => true).catch(() => false);
  }
  const focused = document.activeElement;
  const field = document.createElement('textarea');
  field.value = text;
  field.style.position = 'fixed';
  document.body.append(field);
  field.select();
  const done = document.execCommand('copy');
  field.remove();
  if (focused instanceof HTMLElement) focused.focus();
  return done;
}

/** A button that copies a text and says so. */
export function CopyButton(props: { text: string; class?: string; label?: string; children: ComponentChildren }) {
  const { word } = useStudio();
  const [told, setTold] = useState<'' | 'copied' | 'notCopied'>('');
  const timer = useRef(0);
  useEffect(() => () => clearTimeout(timer.current), []);
  const copy = async () => {
    setTold((await copyText(props.text)) ? 'copied' : 'notCopied');
    clearTimeout(timer.current);
    timer.current = window.setTimeout(() => setTold(''), kCopiedMs);
  };
  return (
    <span class="copying">
      <button type="button" class={props.class} title={props.label} aria-label={props.label} onClick={() => void copy()}>
        {props.children}
      </button>
      <span class="copied" aria-live="polite">
        {told === '' ? '' : word(told)}
      </span>
    </span>
  );
}
