// The editor of the part "Configuration": CodeMirror, in a bundle of its own, which is loaded with that part.
import { type CompletionContext, type CompletionResult, autocompletion, completionKeymap } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap, isolateHistory } from '@codemirror/commands';
import { type Diagnostic, lintGutter, setDiagnostics } from '@codemirror/lint';
import { EditorState } from '@codemirror/state';
import { Decoration, EditorView, MatchDecorator, ViewPlugin, type ViewUpdate, highlightActiveLine, keymap, lineNumbers } from '@codemirror/view';

import type { Suggestion } from './config_schema';

/** A message at its line. Lines and columns count from 1; line 0: of the file as a whole. */
export interface Mark {
  line: number;
  column: number;
  text: string;
  severity: 'error' | 'warning';
}

export interface EditorOptions {
  parent: HTMLElement;
  text: string;
  label: string;
  onText: (text: string) => void;
  onCursor: (text: string, at: number) => void;
  suggest: (text: string, at: number) => { from: number; suggestions: Suggestion[] };
}

export interface ConfigEditor {
  text: () => string;
  /** As a change that can be undone. */
  replace: (text: string) => void;
  mark: (marks: Mark[]) => void;
  goTo: (line: number, column: number) => void;
  close: () => void;
}

const kComment = Decoration.mark({ class: 'comment' });
const kKey = Decoration.mark({ class: 'key' });
const kWords = new MatchDecorator({
  regexp: /(?:^|\s)#.*$|[\w-]+(?=\s*:(?:\s|$))/gm,
  decoration: (match) => (match[0].trimStart().startsWith('#') ? kComment : kKey),
});
const colours = ViewPlugin.define(
  (view) => {
    let decorations = kWords.createDeco(view);
    return {
      get decorations() {
        return decorations;
      },
      update(update: ViewUpdate) {
        decorations = kWords.updateDeco(update, decorations);
      },
    };
  },
  { decorations: (plugin) => plugin.decorations },
);

const theme = EditorView.theme({
  '&': { height: '100%', fontSize: '14px', color: 'var(--ink)', backgroundColor: 'var(--card)' },
  '.cm-scroller': { fontFamily: 'ui-monospace, monospace', lineHeight: '1.45' },
  '.cm-content': { caretColor: 'var(--ink)' },
  '.cm-gutters': { backgroundColor: 'var(--card)', color: 'var(--quiet)', borderRight: '1px solid var(--line)' },
  '.cm-activeLine': { backgroundColor: 'transparent', boxShadow: 'inset 2px 0 0 var(--blue)' },
  '.comment': { color: 'var(--quiet)' },
  '.key': { color: 'var(--blue)' },
  '.cm-tooltip': { color: 'var(--ink)', backgroundColor: 'var(--card)', border: '1px solid var(--line)', maxWidth: '34em' },
  '.cm-tooltip.cm-tooltip-autocomplete > ul > li[aria-selected]': { backgroundColor: 'var(--blue)', color: 'var(--on-colour)' },
  '.cm-diagnostic': { whiteSpace: 'pre-wrap' },
});

function completionOf(options: EditorOptions) {
  return (context: CompletionContext): CompletionResult | null => {
    const { from, suggestions } = options.suggest(context.state.doc.toString(), context.pos);
    if (suggestions.length === 0 || (context.pos === from && !context.explicit)) return null;
    return {
      from,
      options: suggestions.map((each) => ({
        label: each.label,
        type: each.isKey ? 'property' : 'enum',
        apply: each.isKey ? `${each.label}: ` : each.label,
        ...(each.about === '' ? {} : { info: each.about }),
      })),
      validFor: /^[\w-]*$/,
    };
  };
}

export function makeEditor(options: EditorOptions): ConfigEditor {
  // In a shadow: its styles are constructed sheets, which the page's policy allows.
  const root = options.parent.attachShadow({ mode: 'open' });
  const view = new EditorView({
    parent: root,
    root,
    state: EditorState.create({
      doc: options.text,
      extensions: [
        lineNumbers(),
        history(),
        highlightActiveLine(),
        colours,
        theme,
        lintGutter(),
        // In the order of the schema.
        autocompletion({ override: [completionOf(options)], icons: false, compareCompletions: () => 0 }),
        // Tab leaves the editor, as everywhere on the page.
        keymap.of([...completionKeymap, ...defaultKeymap, ...historyKeymap]),
        EditorView.contentAttributes.of({ 'aria-label': options.label, tabindex: '0' }),
        EditorView.updateListener.of((update) => {
          if (update.docChanged) options.onText(update.state.doc.toString());
          if (update.docChanged || update.selectionSet) options.onCursor(update.state.doc.toString(), update.state.selection.main.head);
        }),
      ],
    }),
  });
  const at = (line: number, column: number): number => {
    const found = view.state.doc.line(Math.min(Math.max(1, line), view.state.doc.lines));
    return Math.min(found.from + Math.max(0, column - 1), found.to);
  };
  return {
    text: () => view.state.doc.toString(),
    replace: (text) =>
      view.dispatch({
        changes: { from: 0, to: view.state.doc.length, insert: text },
        selection: { anchor: 0 },
        scrollIntoView: true,
        annotations: isolateHistory.of('full'),
      }),
    mark: (marks) => {
      const diagnostics = marks.map((mark): Diagnostic => {
        const from = at(mark.line, mark.column);
        const word = /^[\w.'"-]+/.exec(view.state.doc.sliceString(from, view.state.doc.lineAt(from).to));
        return { from, to: from + (word?.[0].length ?? 0), severity: mark.severity, message: mark.text };
      });
      view.dispatch(setDiagnostics(view.state, diagnostics));
    },
    goTo: (line, column) => {
      view.dispatch({ selection: { anchor: at(line, column) }, scrollIntoView: true });
      view.focus();
    },
    close: () => view.destroy(),
  };
}
