/** Which language the page speaks: the chosen one, kept on this tablet, or else the tablet's own. */

import { de } from './de';
import { en, type Words } from './en';
import { es } from './es';
import { zh } from './zh';

export const LANGUAGES = { en: 'English', zh: '中文', de: 'Deutsch', es: 'Español' } as const;
export type Language = keyof typeof LANGUAGES;

const WORDS: Record<Language, Words> = { en, zh, de, es };
const KEPT_AS = 'kinebox.language';

/** The first of the wished languages ("de-AT" is a wish for "de") that the page speaks; null if it speaks none. */
export function spoken(wished: readonly string[]): Language | null {
  const found = wished.map((wish) => wish.toLowerCase().split('-')[0]!).find((code) => code in LANGUAGES);
  return (found as Language | undefined) ?? null;
}

let chosen = $state<Language>('en');
/** Nobody wished for this language. */
let guessed = false;

export const language = (): Language => chosen;
/** Every word on the page, in the language that is spoken. */
export const words = (): Words => WORDS[chosen];

export function speak(code: Language): void {
  begin(code);
  guessed = false;
  try {
    localStorage.setItem(KEPT_AS, code);
  } catch {
    // A browser that keeps nothing still speaks.
  }
}

/** To be called once, before anything is shown. */
export function speakAsBefore(): void {
  let kept: string | null = null;
  try {
    kept = localStorage.getItem(KEPT_AS);
  } catch {
    // As above.
  }
  const wished = spoken(kept === null ? navigator.languages : [kept, ...navigator.languages]);
  guessed = wished === null;
  begin(wished ?? 'en');
}

/** The language of the school, for a tablet whose own the page does not speak. */
export function suggest(code: string | undefined): void {
  const known = spoken(code === undefined ? [] : [code]);
  if (guessed && known !== null) begin(known);
}

function begin(code: Language): void {
  chosen = code;
  document.documentElement.lang = code;
}

/** One of a text's languages: the spoken one, English, or whichever there is; null if there is none. */
export function said(text: Readonly<Record<string, string>> | undefined): string | null {
  if (text === undefined) return null;
  return text[chosen] ?? text['en'] ?? Object.values(text)[0] ?? null;
}
