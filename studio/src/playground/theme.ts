// The theme of the book: light or dark.

import type { Theme } from '../scene/palette';

/** Dark themes of the book. */
const DARK = ['coal', 'navy', 'ayu'];

export const bookTheme = (): Theme => (DARK.some((name) => document.documentElement.classList.contains(name)) ? 'dark' : 'light');

/** Calls a function now and whenever the theme changes, until the returned function is called. */
export function followTheme(follow: () => void): () => void {
  follow();
  const observer = new MutationObserver(follow);
  observer.observe(document.documentElement, { attributes: true, attributeFilter: ['class'] });
  return () => observer.disconnect();
}
