import { describe, expect, it } from 'vitest';

import {
  ALTITUDE_SCALES,
  compassPoint,
  DASHES,
  headingLabel,
  headingText,
  reading,
  tapeScale,
  tapeTicks,
  verticalSpeedOffset,
  wrap180,
  wrap360,
} from './numbers';

describe('reading', () => {
  it('shows dashes for unknown values, never a zero', () => {
    expect([null, undefined, NaN, Infinity].map((value) => reading(value))).toEqual([DASHES, DASHES, DASHES, DASHES]);
    expect(reading(0)).toBe('0');
  });

  it('has no negative zero', () => {
    expect(reading(-0.04, 1)).toBe('0.0');
    expect(reading(-0.06, 1)).toBe('-0.1');
  });
});

describe('angles', () => {
  it('wraps', () => {
    expect([-10, 360, 725].map(wrap360)).toEqual([350, 0, 5]);
    expect([190, 180, -190, 179].map(wrap180)).toEqual([-170, -180, 170, 179]);
  });

  it('writes headings with three digits, and north as 000 also after rounding', () => {
    expect([0, 359.7, 7, -1, null].map((value) => headingText(value))).toEqual(['000', '000', '007', '359', DASHES]);
    expect([0, 90, 180, 270, 360, 30].map(headingLabel)).toEqual(['N', 'E', 'S', 'W', 'N', '030']);
    expect([359, 44, 100].map(compassPoint)).toEqual(['N', 'NE', 'E']);
  });
});

describe('tapes', () => {
  it('puts ticks at multiples, negative ones too', () => {
    const ticks = tapeTicks(1, 5, 2, 2);
    expect(ticks.map((tick) => tick.value)).toEqual([-4, -2, 0, 2, 4, 6]);
    expect(ticks.filter((tick) => tick.isMajor).map((tick) => tick.value)).toEqual([-4, 0, 4]);
    expect(ticks[0]?.offset).toBe(-5);
  });

  it('takes a coarser scale for large values', () => {
    expect(tapeScale(12, ALTITUDE_SCALES).minor).toBe(2);
    expect(tapeScale(-900, ALTITUDE_SCALES).minor).toBe(10);
    expect(tapeScale(1e6, ALTITUDE_SCALES).minor).toBe(50);
  });

  it('compresses the vertical speed and ends at full scale', () => {
    expect(verticalSpeedOffset(2.5, 10)).toBe(0.5);
    expect(verticalSpeedOffset(-40, 10)).toBe(-1);
  });
});
