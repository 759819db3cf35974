import { expect, it } from 'vitest';
import type { VehicleType } from '$lib/vehicle/Vehicle';

import { attitudeFaces, project, rotated } from './attitude';
import { numberText } from './reading.svelte';

const QUARTER = Math.PI / 2;
const near = (point: object, expected: object): void => {
  for (const [key, value] of Object.entries(expected))
    expect((point as Record<string, number>)[key]).toBeCloseTo(value);
};

it('turns as aircraft do', () => {
  near(rotated([1, 0, 0], 0, QUARTER, 0), { x: 0, y: 0, z: -1 });
  near(rotated([1, 0, 0], 0, 0, QUARTER), { x: 0, y: 1, z: 0 });
  near(rotated([0, 1, 0], QUARTER, 0, 0), { x: 0, y: 0, z: 1 });
});

it('draws what is far first, in a picture of bounded size', () => {
  const faces = attitudeFaces(0.3, 0.2, 1);
  expect(faces).toHaveLength(10);
  for (const { points, light } of faces) {
    expect(light).toBeLessThanOrEqual(1.3);
    for (const [x, y] of points) expect(Math.hypot(x, y)).toBeLessThan(2);
  }
});

it('shows right to the right and up above', () => {
  expect(project({ x: 0, y: 1, z: 0 })[0]).toBeGreaterThan(0);
  expect(project({ x: 0, y: 0, z: -1 })[1]).toBeLessThan(0);
});

it('writes a number that rounds to zero without a sign', () => {
  expect([-0.2, -0.6, 0.2].map((value) => numberText(value, 0))).toEqual(['0', '-1', '0']);
  expect(numberText(-0.001, 2)).toBe('0.00');
});

it('draws the kind of vehicle that it is: a plane where that is not known', () => {
  const parts = (...type: [VehicleType?]) =>
    attitudeFaces(0, 0, 0, ...type).map(({ part, points }) => [part, points.length]);
  expect(parts('plane')).toEqual(parts());
  const rotors = (type: VehicleType) => parts(type).filter(([, corners]) => corners === 8).length;
  expect((['plane', 'copter', 'vtol', 'helicopter', 'rover'] as const).map(rotors)).toEqual([0, 4, 4, 1, 0]);
  for (const type of ['copter', 'helicopter', 'vtol', 'rover', 'boat', 'sub'] as const) {
    for (const { points } of attitudeFaces(0.4, -0.3, 2, type)) {
      for (const [x, y] of points) expect(Math.hypot(x, y)).toBeLessThan(2);
    }
  }
});
