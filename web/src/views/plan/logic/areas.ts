/**
 * Tracks that cover an area with obstacles: the planner of `mavstack.swarm.search`, step by step.
 *
 * The area is cut into parallel strips. In each strip it is one interval or several; intervals of neighbouring strips
 * that touch each other, and no other, belong to one cell, which is flown back and forth (boustrophedon).
 * The vectors in `conformance/survey` hold for both implementations.
 */

import type { Corner } from '$lib/map/localFrame';

type Interval = readonly [number, number];
type Ring = readonly Corner[];

/** A straight leg, in metres north and east. */
export interface Track {
  readonly start: Corner;
  readonly end: Corner;
}

const SAME = 1e-9;

/** Returns the area of a ring in square metres. */
export function ringSize(ring: Ring): number {
  let twice = 0;
  ring.forEach(([north, east], index) => {
    const [nextNorth, nextEast] = ring[(index + 1) % ring.length]!;
    twice += north * nextEast - nextNorth * east;
  });
  return Math.abs(twice) / 2;
}

/** Returns the direction of tracks, in degrees, for which an area needs the fewest. */
export function bestBearing(outline: Ring): number {
  const bearings = outline.map(([north, east], index) => {
    const [nextNorth, nextEast] = outline[(index + 1) % outline.length]!;
    const degrees = (Math.atan2(nextEast - east, nextNorth - north) * 180) / Math.PI;
    return ((degrees % 180) + 180) % 180;
  });
  const extent = (bearing: number): number => {
    const across = toSweep(outline, bearing).map(([, each]) => each);
    return Math.round((Math.max(...across) - Math.min(...across)) * 1e6) / 1e6;
  };
  const ranked = bearings.map((bearing) => ({ bearing, extent: extent(bearing) }));
  ranked.sort((one, other) => one.extent - other.extent || one.bearing - other.bearing);
  return ranked[0]!.bearing;
}

/** Returns the tracks of each cell, side by side, all in one direction; empty: there would be more than `limit`. */
export function cover(rings: readonly Ring[], spacing: number, bearing: number, limit: number): Track[][] {
  const swept = rings.map((ring) => toSweep(ring, bearing));
  const heights = swept[0]!.map(([, height]) => height);
  const low = Math.min(...heights);
  const strips = Math.max(1, Math.ceil((Math.max(...heights) - low) / spacing - SAME));
  if (strips > limit) return [];
  const width = (Math.max(...heights) - low) / strips;
  const rows = Array.from({ length: strips }, (_, index) => stripIntervals(swept, low + index * width, width));
  return cellsOf(rows).map((cell) =>
    cell.map(({ row, interval }) => {
      const height = low + (row + 0.5) * width;
      const [start, end] = toSweep(
        interval.map((along): Corner => [along, height]),
        -bearing,
      );
      return { start: start!, end: end! };
    }),
  );
}

/** Returns points as metres along and across a bearing. */
export function toSweep(points: Ring, bearing: number): Corner[] {
  const angle = (bearing * Math.PI) / 180;
  const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
  return points.map(([north, east]) => [cosine * north + sine * east, cosine * east - sine * north]);
}

function stripIntervals(rings: readonly Ring[], low: number, width: number): Interval[] {
  const heights = new Set([SAME, 0.5, 1 - SAME].map((share) => low + width * share));
  for (const ring of rings) {
    for (const [, height] of ring) {
      if (height <= low || height >= low + width) continue;
      heights.add(height - 1e-6 * width).add(height + 1e-6 * width);
    }
  }
  const rows = [...heights].sort((one, other) => one - other).map((height) => intervals(rings, height));
  const middle = intervals(rings, low + 0.5 * width);
  return connected(rows)
    .flatMap((part) => extents(part, middle))
    .sort((one, other) => one[0] - other[0] || one[1] - other[1]);
}

/** Returns the parts of a line that are inside of the area, by the even-odd rule. */
function intervals(rings: readonly Ring[], height: number): Interval[] {
  const crossings: number[] = [];
  for (const ring of rings) {
    ring.forEach(([along, across], index) => {
      const [nextAlong, nextAcross] = ring[(index + 1) % ring.length]!;
      if (across > height === nextAcross > height) return;
      crossings.push(along + ((height - across) / (nextAcross - across)) * (nextAlong - along));
    });
  }
  crossings.sort((one, other) => one - other);
  const found: Interval[] = [];
  for (let index = 0; index + 1 < crossings.length; index += 2) {
    if (crossings[index + 1]! > crossings[index]!) found.push([crossings[index]!, crossings[index + 1]!]);
  }
  return found;
}

const touch = (one: Interval, other: Interval): boolean => one[0] < other[1] && other[0] < one[1];

/**
 * Returns the intervals of each connected part of a strip. Between two rows with as many intervals there is no
 * corner: the n-th of one continues in the n-th of the other.
 */
function connected(rows: readonly (readonly Interval[])[]): Interval[][] {
  const parts = new Map<number, Interval[]>();
  let before: { interval: Interval; part: number }[] = [];
  let made = 0;
  for (const row of rows) {
    const isSame = row.length === before.length;
    let present: typeof before = [];
    row.forEach((interval, index) => {
      const linked = new Set(
        isSame
          ? [before[index]!.part]
          : before.filter((each) => touch(each.interval, interval)).map(({ part }) => part),
      );
      const part = linked.size > 0 ? Math.min(...linked) : made++;
      const joined = (each: (typeof before)[number]): (typeof before)[number] =>
        linked.has(each.part) ? { ...each, part } : each;
      for (const other of linked) {
        if (other === part) continue;
        parts.get(part)!.push(...parts.get(other)!);
        parts.delete(other);
      }
      [before, present] = [before.map(joined), present.map(joined)];
      parts.set(part, [...(parts.get(part) ?? []), interval]);
      present.push({ interval, part });
    });
    before = present;
  }
  return [...parts.values()];
}

/** Returns the extent of a part, or one for each interval that it has in the middle of the strip. */
function extents(part: readonly Interval[], middle: readonly Interval[]): Interval[] {
  const isIn = ([first, last]: Interval): boolean => part.some((each) => each[0] === first && each[1] === last);
  const own = middle.filter(isIn);
  const lows = (from: readonly Interval[]): number => Math.min(...from.map(([first]) => first));
  const highs = (from: readonly Interval[]): number => Math.max(...from.map(([, last]) => last));
  if (own.length < 2) return [[lows(part), highs(part)]];
  return own.map((interval, index) => {
    const near = part.filter((each) => touch(each, interval));
    return [
      Math.max(own[index - 1]?.[1] ?? -Infinity, lows(near)),
      Math.min(own[index + 1]?.[0] ?? Infinity, highs(near)),
    ];
  });
}

interface Placed {
  readonly row: number;
  readonly interval: Interval;
}

/** Returns cells: runs of intervals in which each touches one of the row before, which touches no other. */
function cellsOf(rows: readonly (readonly Interval[])[]): Placed[][] {
  const done: Placed[][] = [];
  let open = new Map<number, Placed[]>();
  let before: readonly Interval[] = [];
  rows.forEach((row, number) => {
    const below = row.map((interval) => before.flatMap((each, old) => (touch(each, interval) ? [old] : [])));
    const counts = before.map((_, old) => below.filter((each) => each.includes(old)).length);
    const going = new Map<number, Placed[]>();
    row.forEach((interval, index) => {
      const [old] = below[index]!;
      const isAlone = below[index]!.length === 1 && counts[old!] === 1;
      const cell = isAlone ? (open.get(old!) ?? []) : [];
      if (isAlone) open.delete(old!);
      going.set(index, [...cell, { row: number, interval }]);
    });
    done.push(...open.values());
    [open, before] = [going, row];
  });
  return [...done, ...open.values()];
}

const gap = (one: Corner, other: Corner): number => Math.hypot(one[0] - other[0], one[1] - other[1]);
const reversedTrack = ({ start, end }: Track): Track => ({ start: end, end: start });

/** Returns the tracks of all cells as one vehicle flies them; `start` is from where it comes. */
export function orderTracks(cells: readonly (readonly Track[])[], start: Corner | null, turnRadius = 0): Track[] {
  const waiting = cells.filter((cell) => cell.length > 0);
  const ordered: Track[] = [];
  let here = start ?? waiting[0]?.[0]?.start ?? [0, 0];
  while (waiting.length > 0) {
    let best: { distance: number; number: number; line: Track[] } | null = null;
    waiting.forEach((cell, number) => {
      for (const line of waysThrough(cell, turnRadius)) {
        const distance = gap(here, line[0]!.start);
        if (best === null || distance < best.distance) best = { distance, number, line };
      }
    });
    const { number, line } = best! as { number: number; line: Track[] };
    waiting.splice(number, 1);
    ordered.push(...line);
    here = line.at(-1)!.end;
  }
  return ordered;
}

/** Returns the four ways to fly a cell: from either side, beginning in either direction. */
function waysThrough(cell: readonly Track[], turnRadius: number): Track[][] {
  return [[...cell], [...cell].reverse()].flatMap((side) => {
    const rows = interleaved(side, turnRadius);
    return [false, true].map((isReversed) =>
      rows.map((track, index) => ((index % 2 === 1) !== isReversed ? reversedTrack(track) : track)),
    );
  });
}

/** Returns rows so that consecutive ones are two radii apart, for wings. */
function interleaved(rows: Track[], turnRadius: number): Track[] {
  if (turnRadius <= 0 || rows.length < 3) return rows;
  const half = Math.floor((rows.length + 1) / 2);
  const skip = Math.min(Math.max(1, Math.ceil((2 * turnRadius) / rowDistance(rows) - SAME) + 1), half);
  if (skip <= 2) return rows;
  const ordered: Track[] = [];
  for (let begin = 0; begin < rows.length; begin += 2 * skip - 1) {
    const block = rows.slice(begin, begin + 2 * skip - 1);
    for (let index = 0; index < skip; index += 1) {
      ordered.push(...block.slice(index, index + 1), ...block.slice(index + skip, index + skip + 1));
    }
  }
  return ordered;
}

function rowDistance([first, second]: readonly Track[]): number {
  const along: Corner = [first!.end[0] - first!.start[0], first!.end[1] - first!.start[1]];
  const apart: Corner = [second!.start[0] - first!.start[0], second!.start[1] - first!.start[1]];
  const length = Math.hypot(...along);
  return length > 0 ? Math.abs(along[0] * apart[1] - along[1] * apart[0]) / length : Math.hypot(...apart);
}
