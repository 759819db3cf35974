/** The catalogue is whole: components have no texts of their own, and no text of it is left over. */

import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

import { parse, type AST } from 'svelte/compiler';
import { afterEach, describe, expect, it } from 'vitest';

import { addLanguage, chooseLanguage, setLanguage, t } from '.';
import { en } from './en';

const SOURCES = join(import.meta.dirname, '..', '..');
/** Attributes whose texts people see or hear. */
const SHOWN = new Set([
  'aria-label',
  'aria-description',
  'aria-valuetext',
  'alt',
  'label',
  'placeholder',
  'title',
  'hint',
]);
/** Two letters in a row are a word, others are symbols such as × and °. */
const WORD = /\p{L}{2}/u;
/** Names and keys, in every language. */
const NAMES = new Set(['MAV_FRAME', 'Terrarium', 'Terrain-RGB', '(Ctrl+Z)', '(Ctrl+Shift+Z)']);

/** Milliseconds: a busy machine parses all components slowly. */
const PATIENT = 60_000;

const files = readdirSync(SOURCES, { recursive: true, encoding: 'utf8' }).filter(
  (name) => !name.startsWith('generated'),
);
const read = (name: string): string => readFileSync(join(SOURCES, name), 'utf8');

/** Returns the texts that stand in a component's markup, outside of expressions. */
function ownTexts(source: string): string[] {
  const found: string[] = [];
  const visit = (node: unknown): void => {
    if (Array.isArray(node)) return node.forEach(visit);
    if (node === null || typeof node !== 'object') return;
    const { type, name, value, data } = node as { type?: string; name?: string; value?: unknown; data?: string };
    if (type === 'Text' && data !== undefined) found.push(data.trim());
    if (type === 'StyleDirective' || (type === 'Attribute' && !SHOWN.has(name ?? ''))) return visitExpressions(value);
    Object.entries(node).forEach(([key, child]) => key !== 'metadata' && visit(child));
  };
  const visitExpressions = (value: unknown): void => {
    if (Array.isArray(value)) value.filter((each: AST.BaseNode) => each.type !== 'Text').forEach(visit);
    else visit(value);
  };
  visit(parse(source, { modern: true }).fragment);
  return found.filter((text) => WORD.test(text) && !NAMES.has(text));
}

describe('catalogue', () => {
  it(
    'has all texts of the components',
    () => {
      const components = files.filter((name) => name.endsWith('.svelte'));
      const own = components.flatMap((name) => ownTexts(read(name)).map((text) => `${name}: ${text}`));
      expect(own).toEqual([]);
    },
    PATIENT,
  );

  it('finds texts in markup and in attributes', () => {
    expect(ownTexts('<p class="wide">Hold <b title="Two words">{t("a.b")}</b> ×</p>')).toEqual(['Hold', 'Two words']);
  });

  it('has no text that nothing shows', () => {
    const all = files
      .filter((name) => /\.(svelte|ts)$/.test(name) && !name.includes('i18n'))
      .map(read)
      .join('\n');
    const parts = Object.entries(en).flatMap(([part, texts]) => Object.keys(texts).map((name) => `${part}.${name}`));
    // A key that is put together, such as `shell.${view}`, uses all texts of its beginning.
    const beginnings = [...all.matchAll(/[`'"](\w+\.\w*)\$\{/g)].map(([, beginning]) => beginning!);
    const shown = new Set([...all.matchAll(/'(\w+\.\w+)'/g)].map(([, key]) => key!));
    const unused = parts.filter((key) => !shown.has(key) && !beginnings.some((each) => key.startsWith(each)));
    expect(unused).toEqual([]);
  });

  it('counts with the form that fits the number', () => {
    expect([0, 1, 2].map((count) => t('setup.found', { count }))).toEqual([
      '0 parameters',
      '1 parameter',
      '2 parameters',
    ]);
    expect(t('sources.rows', { received: 1, refused: 3 })).toBe('1 row, 3 lines refused');
    expect(t('inspect.packetBytes', { count: 12, source: '$& {count}' })).toBe('12 bytes from $& {count}');
    const texts = Object.values(en).flatMap((part) => Object.values(part));
    expect(texts.filter((text) => /\{count\} [a-z]+s\b(?!\/)/.test(text))).toEqual([
      'A spectrum needs {count} values.',
    ]);
  });
});

describe('languages', () => {
  afterEach(() => setLanguage('en'));

  it('takes the first of a person that has a catalogue', () => {
    addLanguage('de', { shell: { fly: 'Fliegen' } });
    expect(chooseLanguage(['fr-FR', 'de-AT', 'en'])).toBe('de');
    expect([t('shell.fly'), t('shell.plan')]).toEqual(['Fliegen', 'Plan']);
    addLanguage('pl', { setup: { found: '{count, one: # parametr, few: # parametry, other: # parametrów}' } });
    setLanguage('pl');
    expect([1, 3, 5].map((count) => t('setup.found', { count }))).toEqual([
      '1 parametr',
      '3 parametry',
      '5 parametrów',
    ]);
    expect(chooseLanguage(['fr', 'it'])).toBe('en');
    expect(t('shell.fly')).toBe('Fly');
  });
});
