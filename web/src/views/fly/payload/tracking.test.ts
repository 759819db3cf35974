import { expect, it } from 'vitest';

import { areaOf } from './tracking';

it('tracks the point of a click and the rectangle of a drag, within the picture', () => {
  expect(areaOf({ x: 0.4, y: 0.2 }, { x: 0.41, y: 0.2 }, true)).toEqual({ kind: 'point', x: 0.4, y: 0.2 });
  expect(areaOf({ x: 0.8, y: 0.9 }, { x: -0.2, y: 0.5 }, true)).toEqual({
    kind: 'rectangle',
    left: 0,
    top: 0.5,
    right: 0.8,
    bottom: 0.9,
  });
  expect(areaOf({ x: 0.8, y: 0.9 }, { x: 0.1, y: 0.5 }, false).kind).toBe('point');
});
