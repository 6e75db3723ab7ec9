/** The reason why something was refused, announced where it was asked for; empty: nothing was. */
export function Refusal(props: { why: string }) {
  if (props.why === '') return null;
  return (
    <span class="refused" role="alert">
      {props.why}
    </span>
  );
}
