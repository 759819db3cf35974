import { expect, it } from 'vitest';
import { clampPlace, compacted, overlaps, readingOrder, rowsOf, withPlace, withWidget, withoutWidget } from './layout';
import { EMPTY, newWidget, type Dashboard } from './model';

function dashboard(...kinds: ('plot' | 'gauge' | 'map')[]): Dashboard {
  return kinds.reduce((found, kind) => withWidget(found, newWidget(kind)), EMPTY);
}

function assertNoOverlap({ widgets }: Dashboard): void {
  for (const a of widgets) for (const b of widgets) if (a !== b) expect(overlaps(a, b)).toBe(false);
}

it('adds widgets below each other with ids of their own', () => {
  const { widgets } = dashboard('plot', 'gauge', 'plot');
  expect(widgets.map(({ id, y }) => [id, y])).toEqual([
    ['w1', 0],
    ['w2', 5],
    ['w3', 9],
  ]);
});

it('pushes covered widgets down when one moves, and lets them rise', () => {
  const moved = withPlace(dashboard('plot', 'gauge'), 'w2', { x: 0, y: 0, width: 3, height: 4 });
  assertNoOverlap(moved);
  expect(moved.widgets.map(({ id, y }) => [id, y])).toEqual([
    ['w1', 4],
    ['w2', 0],
  ]);
  const aside = withPlace(moved, 'w2', { x: 9, y: 0, width: 3, height: 4 });
  expect(aside.widgets.map(({ y }) => y)).toEqual([0, 0]);
});

it('never overlaps, whatever is moved', () => {
  let current = dashboard('plot', 'gauge', 'map', 'plot', 'gauge');
  let random = 7;
  const next = (limit: number): number => (random = (random * 16_807) % 2_147_483_647) % limit;
  for (let step = 0; step < 200; step++) {
    const place = { x: next(14) - 1, y: next(20), width: next(14), height: next(9) };
    current = withPlace(current, `w${1 + next(5)}`, place);
    assertNoOverlap(current);
  }
});

it('keeps places within the grid', () => {
  expect(clampPlace({ x: 99, y: -3, width: 40, height: 0 })).toEqual({ x: 0, y: 0, width: 12, height: 1 });
  expect(clampPlace({ x: NaN, y: NaN, width: NaN, height: NaN })).toEqual({ x: 0, y: 0, width: 1, height: 1 });
});

it('removes a widget and closes the gap', () => {
  const left = withoutWidget(dashboard('plot', 'gauge'), 'w1');
  expect(left.widgets.map(({ id, y }) => [id, y])).toEqual([['w2', 0]]);
  expect(rowsOf(left.widgets)).toBe(4);
});

it('reads from the top to the bottom and from left to right', () => {
  const placed = compacted(withPlace(dashboard('gauge', 'gauge'), 'w2', { x: 4, y: 0, width: 3, height: 4 }).widgets);
  expect(readingOrder([...placed].reverse()).map(({ id }) => id)).toEqual(['w1', 'w2']);
});
