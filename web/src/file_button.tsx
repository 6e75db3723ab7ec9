// A button that opens a file of the user's computer.
import { useRef } from 'preact/hooks';

export function FileButton(props: { text: string; accept: string; onFile: (file: File) => void }) {
  const input = useRef<HTMLInputElement>(null);
  return (
    <>
      <button type="button" onClick={() => input.current?.click()}>
        {props.text}
      </button>
      <input
        ref={input}
        type="file"
        accept={props.accept}
        hidden
        aria-label={props.text}
        onChange={(event) => {
          const file = event.currentTarget.files?.[0];
          if (file !== undefined) props.onFile(file);
          // The same file may be opened again.
          event.currentTarget.value = '';
        }}
      />
    </>
  );
}
