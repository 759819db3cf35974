import { expect, it } from 'vitest';
import { queryOf, toggled } from './form';

const FORM = { dialect: 'common', languages: ['c', 'go'], only: ' GPS* ', exclude: '', package: '' };

it('makes the query of the form', () => {
  expect(queryOf(FORM, null)).toEqual({ dialect: 'common', languages: 'c,go', only: 'GPS*' });
  expect(queryOf(FORM, { name: 'my ship.xml' })).toEqual({ file: 'my ship.xml', languages: 'c,go', only: 'GPS*' });
  expect(queryOf(FORM, { name: 'Schiff (2).xml' })).toEqual({ languages: 'c,go', only: 'GPS*' });
});

it('keeps the languages in their order', () => {
  expect(toggled(['go'], 'c', ['c', 'lua', 'go'])).toEqual(['c', 'go']);
  expect(toggled(['c', 'go'], 'c', ['c', 'lua', 'go'])).toEqual(['go']);
});
