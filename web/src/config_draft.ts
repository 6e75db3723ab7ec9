// The text in the part "Configuration", also while another part of the page is shown.

export interface Draft {
  text: string;
  /** As it was loaded. */
  loaded: string;
  from: string;
  hidden: number;
  /** SHA-256 of the robot's file that it replaces; '': of the one that the robot has now. */
  replaces: string;
}
export const kDraft: Draft = { text: '', loaded: '', from: '', hidden: 0, replaces: '' };

/** Text as the editor has it: without a byte order mark, its lines ended by LF. */
export const plain = (text: string) => text.replace(/^\ufeff/, '').replace(/\r\n?/g, '\n');

/** A change of another part, and its result in the editor: of the draft where that began as the file that runs, else of that file.
 * False: the change found no place. Tokens that were hidden stay so. */
export function putIntoDraft(file: string, change: (text: string) => string | null, from: string): boolean {
  const running = plain(file);
  const text = change(kDraft.loaded === running ? kDraft.text : running);
  if (text === null) return false;
  Object.assign(kDraft, { text, loaded: running, from, replaces: '', hidden: /\bhidden-\d\d-/.test(text) ? 1 : 0 });
  document.getElementById('tab-configuration')?.click();
  return true;
}
