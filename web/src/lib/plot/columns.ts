/**
 * From rings to the columns that uPlot draws: one column of times in seconds, one of values for each series.
 *
 * Series of different rates share the column of times; a series has null where only another one has a value.
 * A series with many more values than pixels is reduced to the smallest and the largest value of each pixel,
 * so that peaks stay visible.
 */
import type { Ring } from './Ring';

export type Columns = [number[], ...(number | null)[][]];

interface Point {
  readonly time: number;
  readonly value: number;
}

/**
 * @param from first time in ms
 * @param to last time in ms
 * @param pixels width of the plot; at most two values per series and pixel are returned
 */
export function columnsOf(rings: readonly Ring[], from: number, to: number, pixels: number): Columns {
  const series = rings.map((ring) => reduce(ring, from, to, Math.max(1, pixels)));
  const times = [...new Set(series.flatMap((points) => points.map((point) => point.time)))].sort((a, b) => a - b);
  const places = new Map(times.map((time, index) => [time, index]));
  const columns = series.map((points) => {
    const column: (number | null)[] = new Array<number | null>(times.length).fill(null);
    for (const point of points) column[places.get(point.time)!] = Number.isFinite(point.value) ? point.value : null;
    return column;
  });
  return [times.map((time) => time / 1000), ...columns];
}

function reduce(ring: Ring, from: number, to: number, pixels: number): Point[] {
  // One value before the window: the line comes in from the left edge.
  const first = Math.max(0, ring.indexAt(from) - 1);
  const end = Math.min(ring.length, ring.indexAt(to) + 1);
  const points: Point[] = [];
  if (end - first <= 2 * pixels) {
    for (let index = first; index < end; index++) points.push(pointAt(ring, index));
    return points;
  }
  const width = (end - first) / pixels;
  for (let pixel = 0; pixel < pixels; pixel++) {
    points.push(...extremes(ring, Math.floor(first + pixel * width), Math.floor(first + (pixel + 1) * width)));
  }
  return points;
}

function extremes(ring: Ring, first: number, end: number): Point[] {
  let low = first;
  let high = first;
  for (let index = first + 1; index < end; index++) {
    if (ring.valueAt(index) < ring.valueAt(low)) low = index;
    if (ring.valueAt(index) > ring.valueAt(high)) high = index;
  }
  if (low === high) return [pointAt(ring, low)];
  return [pointAt(ring, Math.min(low, high)), pointAt(ring, Math.max(low, high))];
}

function pointAt(ring: Ring, index: number): Point {
  return { time: ring.timeAt(index), value: ring.valueAt(index) };
}
