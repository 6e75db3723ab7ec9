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

/** A text that another part has changed; tokens that were hidden in it stay so. */
export function draftConfiguration(text: string, loaded: string, from: string): void {
  Object.assign(kDraft, { text, loaded, from, replaces: '', hidden: /\bhidden-\d\d-/.test(text) ? 1 : 0 });
}
