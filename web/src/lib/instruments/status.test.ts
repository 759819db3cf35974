import { describe, expect, it } from 'vitest';

import { describeFlight, flightLayout, METRIC } from './flight';
import { pitchLadder } from './horizon';
import { batteryLevel, fixName, gpsLevel, linkBars, linkLevel, estimatorLevel, vibrationLevel } from './status';

describe('levels', () => {
  it('judges a battery by its charge, or by its cells', () => {
    expect([0.9, 0.29, 0.1, null].map((remaining) => batteryLevel(remaining))).toEqual([
      'good',
      'warning',
      'critical',
      'unknown',
    ]);
    expect(batteryLevel(null, 3.5)).toBe('warning');
  });

  it('names fixes and judges them', () => {
    expect([0, 3, 6, 99, null].map((fix) => fixName(fix))).toEqual(['no GPS', '3D', 'RTK fixed', 'fix 99', '–']);
    expect(gpsLevel(1, 0, null)).toBe('critical');
    expect(gpsLevel(3, 6, 1)).toBe('warning');
    expect(gpsLevel(3, 14, 0.8)).toBe('good');
  });

  it('loses bars with loss, and all of them with the link', () => {
    expect(linkLevel(9, 0)).toBe('critical');
    expect([0, 0.05, 0.2, 0.5].map((loss) => linkBars(linkLevel(0.1, loss), loss))).toEqual([4, 3, 2, 1]);
    expect(linkBars('critical', 0)).toBe(0);
  });
});

describe('flight display', () => {
  it('keeps its parts inside of itself at every size', () => {
    for (const [width, height] of [
      [180, 120],
      [330, 220],
      [900, 600],
    ] as const) {
      for (const box of Object.values(flightLayout(width, height))) {
        expect(box.x).toBeGreaterThanOrEqual(0);
        expect(box.x + box.width).toBeLessThanOrEqual(width + 1e-9);
        expect(box.y + box.height).toBeLessThanOrEqual(height + 1e-9);
      }
    }
  });

  it('has rungs around the pitch only', () => {
    expect(pitchLadder(40, false).map((rung) => rung.degrees)).toEqual([25, 30, 35, 40, 45, 50, 55]);
    expect(pitchLadder(90, false).at(-1)?.degrees).toBe(90);
  });

  it('describes itself, with unknown values as such', () => {
    const values = { roll: null, pitch: 2, heading: 87, speed: 12.4, altitude: null, climb: 0 };
    expect(describeFlight(values, METRIC)).toBe(
      'heading 087, altitude unknown m, speed 12 m/s, roll unknown°, pitch 2°',
    );
  });
});

it('warns of estimates that sensors contradict, and of vibrations', () => {
  expect([0.2, 0.7, 1, null].map((ratio) => estimatorLevel(ratio))).toEqual(['good', 'warning', 'critical', 'unknown']);
  expect(estimatorLevel(0, false)).toBe('critical');
  expect([5, 31, 61, null].map(vibrationLevel)).toEqual(['good', 'warning', 'critical', 'unknown']);
});
