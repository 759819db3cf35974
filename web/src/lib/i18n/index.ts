/**
 * Texts of the user interface: `t('fly.takeoff')`, with values: `t('fly.several', { count: 3 })`.
 *
 * A text has values as `{name}`, and the forms of a number as `{name, one: # vehicle, other: # vehicles}`: `#` is the
 * number, the words before the colons are the categories of `Intl.PluralRules` for the language.
 */

import { en } from './en';

type Catalogue = typeof en;

/** Key of a text: the name of its part, a dot, and its name there. */
export type TextKey = { [Part in keyof Catalogue]: `${Part}.${keyof Catalogue[Part] & string}` }[keyof Catalogue];
export type TextValues = Readonly<Record<string, string | number>>;
type Texts = Readonly<Record<string, Readonly<Record<string, string>>>>;

/** Catalogues of other languages; texts that one lacks are shown in English. */
const catalogues: Record<string, Texts> = { en };
let current: Texts = en;
let plurals = new Intl.PluralRules('en');

const VALUE = /\{(\w+)((?:, \w+: [^,{}]*)*)\}/g;

/** Adds a language, such as `addLanguage('de', { shell: { fly: 'Fliegen' } })`. */
export function addLanguage(code: string, texts: Texts): void {
  catalogues[code] = texts;
}

export function setLanguage(code: string): void {
  const isKnown = code in catalogues;
  current = isKnown ? catalogues[code]! : en;
  plurals = new Intl.PluralRules(isKnown ? code : 'en');
}

/** Sets the first of a person's languages that has a catalogue, and returns its code: `de-AT` takes `de`. */
export function chooseLanguage(preferred: readonly string[]): string {
  const codes = preferred.flatMap((code) => [code, code.split('-')[0]!]);
  const code = codes.find((each) => each in catalogues) ?? 'en';
  setLanguage(code);
  return code;
}

/** Returns a text with its values in place of `{name}`. */
export function t(key: TextKey, values: TextValues = {}): string {
  const [part, name] = key.split('.') as [string, string];
  const text = current[part]?.[name] ?? (en as Texts)[part]?.[name] ?? key;
  return text.replace(VALUE, (whole, value: string, forms: string) => {
    const found = values[value];
    return found === undefined ? whole : formOf(forms, found).replaceAll('#', () => String(found));
  });
}

/** Returns the form of a text that fits a value, such as `# vehicles`; `#` without forms. */
function formOf(forms: string, value: string | number): string {
  const byCategory = new Map([...forms.matchAll(/, (\w+): ([^,]*)/g)].map(([, category, form]) => [category!, form!]));
  return byCategory.get(plurals.select(Number(value))) ?? byCategory.get('other') ?? '#';
}
