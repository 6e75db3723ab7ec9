// A picture of each step of commissioning.
import type { Step } from './commission_record';

const kTurn = 'M 60 14 A 36 36 0 1 0 96 50';

/** The shaft, seen from its output, with a mark. */
function Shaft(props: { mark: string }) {
  return (
    <>
      <circle cx="60" cy="50" r="22" />
      <path d={props.mark} class="mark" />
    </>
  );
}

const kPictures: Record<Step, preact.ComponentChildren> = {
  bus: (
    <>
      <path d="M 8 30 H 112 M 8 38 H 112" />
      <path d="M 30 38 V 60 M 60 38 V 60 M 90 38 V 60" />
      <rect x="20" y="60" width="20" height="20" class="mark" />
      <rect x="50" y="60" width="20" height="20" />
      <rect x="80" y="60" width="20" height="20" />
    </>
  ),
  hand: (
    <>
      <Shaft mark="M 60 50 V 30" />
      <path d={kTurn} class="arrow" marker-end="url(#tip)" />
    </>
  ),
  zero: (
    <>
      <Shaft mark="M 60 50 V 30" />
      <path d="M 60 8 V 22" class="arrow" />
      <text x="66" y="18">
        0°
      </text>
    </>
  ),
  limits: (
    <>
      <Shaft mark="M 60 50 V 30" />
      <path d="M 29 68 A 36 36 0 1 1 91 68" />
      <path d="M 22 72 L 36 64 M 98 72 L 84 64" class="arrow" />
    </>
  ),
  spin: (
    <>
      <Shaft mark="M 60 50 V 30" />
      <path d={kTurn} class="arrow" marker-end="url(#tip)" />
      <text x="78" y="92">
        A
      </text>
    </>
  ),
  step: (
    <>
      <path d="M 8 80 H 40 V 30 H 112" class="target" />
      <path d="M 8 80 H 40 C 52 40 56 22 70 28 S 84 30 112 30" class="arrow" />
    </>
  ),
  end: (
    <>
      <rect x="34" y="10" width="52" height="80" />
      <path d="M 42 28 H 78 M 42 42 H 78 M 42 56 H 66" />
      <path d="M 44 74 L 54 82 L 74 64" class="arrow" />
    </>
  ),
};

export function Picture(props: { step: Step }) {
  return (
    <svg class="step-picture" viewBox="0 0 120 100" aria-hidden="true">
      <defs>
        <marker id="tip" viewBox="0 0 10 10" refX="6" refY="5" markerWidth="5" markerHeight="5" orient="auto-start-reverse">
          <path d="M 0 0 L 10 5 L 0 10 z" />
        </marker>
      </defs>
      {kPictures[props.step]}
    </svg>
  );
}
