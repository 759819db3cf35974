import { describe, expect, it } from 'vitest';
import { fieldLabel, formatFieldRef, matchesSource, numberOf, parseFieldRef } from './fieldRef';

describe('references as text', () => {
  it.each([
    '1/1:ATTITUDE.roll',
    '1:BATTERY_STATUS.voltages[3]',
    'cansat:ROW.altitude',
    'script:climb:OUT.value',
    '*:VFR_HUD.alt',
  ])('reads and writes %s', (text) => expect(formatFieldRef(parseFieldRef(text)!)).toBe(text));

  it.each(['', 'ATTITUDE.roll', '1/1:ATTITUDE', '1:A.b[x]', ':A.b'])('refuses %j', (text) => {
    expect(parseFieldRef(text)).toBeNull();
  });

  it('labels by source and field', () => {
    expect(fieldLabel({ source: '1', message: 'A', field: 'volts', index: 2 })).toBe('1 volts[2]');
  });
});

it('matches systems and components', () => {
  expect(matchesSource('1', '1/1')).toBe(true);
  expect(matchesSource('1/1', '1/1')).toBe(true);
  expect(matchesSource('1', '11/1')).toBe(false);
  expect(matchesSource('1/2', '1/1')).toBe(false);
  expect(matchesSource('*', '9/1')).toBe(true);
  expect(matchesSource('cansat', 'cansat')).toBe(true);
});

it('reads numbers of fields', () => {
  expect(numberOf(3)).toBe(3);
  expect(numberOf(12n)).toBe(12);
  expect(numberOf(NaN)).toBeNull();
  expect(numberOf('text')).toBeNull();
  expect(numberOf([1, 2], 1)).toBe(2);
  expect(numberOf(new Uint8Array([7]), 0)).toBe(7);
  expect(numberOf([1], 5)).toBeNull();
  expect(numberOf(4, 0)).toBeNull();
  expect(numberOf(undefined)).toBeNull();
});
