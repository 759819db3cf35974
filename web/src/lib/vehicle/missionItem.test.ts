import { expect, it } from 'vitest';

import { currentItemNumber, sequenceOf } from './missionItem';

it('the current item is counted from 1, whatever the vehicle counts as item 0', () => {
  const mission = (current: number, total: number | null = 3) => ({ current, total, state: null });
  expect(currentItemNumber({ mission: mission(1), firmware: 'ardupilot' })).toBe(1);
  expect(currentItemNumber({ mission: mission(0), firmware: 'ardupilot' })).toBeNull();
  expect(currentItemNumber({ mission: mission(0), firmware: 'px4' })).toBe(1);
  expect(currentItemNumber({ mission: mission(3), firmware: 'px4' })).toBeNull();
  expect(currentItemNumber({ mission: mission(9, null), firmware: 'px4' })).toBe(10);
  expect(currentItemNumber({ mission: null, firmware: 'px4' })).toBeNull();
});

it('an item is chosen by the number that is shown', () => {
  for (const firmware of ['ardupilot', 'px4'] as const) {
    const mission = { current: sequenceOf(2, firmware), total: 3, state: null };
    expect(currentItemNumber({ mission, firmware })).toBe(2);
  }
});
