import { expect, it } from 'vitest';

import { Fitting, isAnyAway, planPlaces, spanOf } from './fitting';

it('shows the first vehicle, and all that come soon after it', () => {
  const fitting = new Fitting();
  expect([fitting.wants(0, '', true, 0), fitting.wants(20, '', true, 10)]).toEqual([false, true]);
  expect([fitting.wants(20, '', true, 20), fitting.wants(100, '', true, 2000)]).toEqual([false, true]);
  expect(fitting.wants(101, '', true, 9000)).toBe(false);
});

it('shows them beside the panels once these are there, and not whenever a panel changes', () => {
  const fitting = new Fitting();
  expect([fitting.wants(9, '0', true, 0), fitting.wants(9, '320', true, 100)]).toEqual([true, true]);
  expect(fitting.wants(9, '360', true, 9000)).toBe(false);
});

it('leaves the map to a user who moved it', () => {
  const fitting = new Fitting();
  expect([fitting.wants(1, '', true, 0), fitting.wants(2, '320', false, 100)]).toEqual([true, false]);
});

it('shows one more vehicle of a small fleet at any time, and begins again with another link', () => {
  const fitting = new Fitting();
  expect([fitting.wants(1, '', true, 0), fitting.wants(2, '', true, 60_000)]).toEqual([true, true]);
  fitting.reset();
  expect(fitting.wants(3, '', false, 70_000)).toBe(true);
});

it('shows a vehicle again that has flown off the map, every two seconds at most, unless the user moved it', () => {
  const fitting = new Fitting();
  const wants = (now: number, isFree: boolean, isAway: boolean) => fitting.wants(1, '', isFree, now, isAway);
  expect([wants(0, true, true), wants(1000, true, true), wants(5000, true, false)]).toEqual([true, false, false]);
  expect([wants(6000, false, true), wants(6000, true, true), wants(7000, true, true)]).toEqual([false, true, false]);
});

it('knows which vehicles are not on the map, or behind a panel', () => {
  const view = { latitude: 47, longitude: 8, zoom: 15, bearing: 0, width: 800, height: 600 };
  const edges = (left: number) => ({ top: 0, right: 0, bottom: 0, left });
  const here = { latitude: 47, longitude: 8 };
  expect([isAnyAway([here], view, edges(0)), isAnyAway([here], view, edges(450))]).toEqual([false, true]);
  expect(isAnyAway([here, { latitude: 47.1, longitude: 8 }], view, edges(0))).toBe(true);
  expect(isAnyAway([], view, edges(0))).toBe(false);
});

it('shows so much that a fast vehicle does not leave the map at once', () => {
  expect([spanOf([]), spanOf([{ groundSpeed: null }, { groundSpeed: 0.2 }]), spanOf([{ groundSpeed: 20 }])]).toEqual([
    80, 80, 800,
  ]);
});

it('shows missions, fences and rally points whole', () => {
  const place = (latitude: number) => ({ latitude, longitude: 8 });
  const stop = { ...place(47), seq: 1, kind: 'loiter', altitude: 50, radius: -1000 } as const;
  const found = planPlaces(
    [stop],
    [
      { kind: 'circle', isInclusion: true, centre: place(46), radius: 2000 },
      { kind: 'polygon', isInclusion: true, corners: [place(48)] },
    ],
    [place(49)],
  );
  const latitudes = found.map(({ latitude }) => latitude);
  expect([Math.max(...latitudes), latitudes.includes(48)]).toEqual([49, true]);
  expect(Math.min(...latitudes)).toBeCloseTo(46 - 2000 / 111_195, 4);
  expect(latitudes.some((latitude) => Math.abs(latitude - (47 + 1000 / 111_195)) < 1e-4)).toBe(true);
});
