import { describe, expect, it } from 'vitest';

import { convert, format, formatDuration, formatNumber, toSi } from './units';

describe('units', () => {
  it.each([
    [12.34, 'speed', 'metric', '12.3 m/s'],
    [10, 'speed', 'imperial', '22.4 mph'],
    [10, 'speed', 'nautical', '19.4 kn'],
    [30.48, 'altitude', 'nautical', '100 ft'],
    [1500, 'distance', 'metric', '1.50 km'],
    [1852, 'distance', 'nautical', '1.00 nm'],
    [999, 'distance', 'metric', '999 m'],
    [0.784, 'percent', 'metric', '78%'],
    [271.6, 'heading', 'metric', '272°'],
    [20, 'temperature', 'imperial', '68 °F'],
    [-0.01, 'altitude', 'metric', '0.0 m'],
  ] as const)('%s as %s in %s units is %s', (value, quantity, system, text) => {
    expect(format(value, quantity, undefined, system)).toBe(text);
  });

  it('shows a dash for values that are not known', () => {
    expect([format(null, 'speed'), format(NaN, 'distance'), formatNumber(null, 'voltage')]).toEqual(['–', '–', '–']);
  });

  it('converts back', () => {
    expect(toSi(convert(12.5, 'temperature', 'imperial'), 'temperature', 'imperial')).toBeCloseTo(12.5, 9);
  });

  it('writes durations', () => {
    expect([42, 725, 3723, -5].map(formatDuration)).toEqual(['0:42', '12:05', '1:02:03', '-0:05']);
  });
});
