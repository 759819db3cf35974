/** Fence areas as the mission items that vehicles hold, and back. */

import { CMD, FRAME, item, type Circle, type Item, type Place, type Polygon } from './model';

export interface FenceAreas {
  readonly polygons: readonly Polygon[];
  readonly circles: readonly Circle[];
  readonly returnPoint: Place | null;
  /** Items that are no area. */
  readonly problems: readonly string[];
}

const VERTICES: Readonly<Record<number, boolean>> = {
  [CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION]: true,
  [CMD.NAV_FENCE_POLYGON_VERTEX_EXCLUSION]: false,
};
const CIRCLES: Readonly<Record<number, boolean>> = {
  [CMD.NAV_FENCE_CIRCLE_INCLUSION]: true,
  [CMD.NAV_FENCE_CIRCLE_EXCLUSION]: false,
};

/** Returns the items of a fence: polygons, circles, return point. */
export function fenceItems(areas: Omit<FenceAreas, 'problems'>): Item[] {
  const polygons = areas.polygons.flatMap((polygon) => {
    const command = polygon.inclusion
      ? CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION
      : CMD.NAV_FENCE_POLYGON_VERTEX_EXCLUSION;
    const count = polygon.vertices.length;
    return polygon.vertices.map((at) => fenceItem(command, [count, 0, 0, 0, at.latitude, at.longitude, 0]));
  });
  const circles = areas.circles.map(({ inclusion, center, radius }) => {
    const command = inclusion ? CMD.NAV_FENCE_CIRCLE_INCLUSION : CMD.NAV_FENCE_CIRCLE_EXCLUSION;
    return fenceItem(command, [radius, 0, 0, 0, center.latitude, center.longitude, 0]);
  });
  const home = areas.returnPoint;
  const params = home && [0, 0, 0, 0, home.latitude, home.longitude, home.altitude];
  const last = params ? [fenceItem(CMD.NAV_FENCE_RETURN_POINT, params, FRAME.GLOBAL_RELATIVE_ALT)] : [];
  return [...polygons, ...circles, ...last];
}

/** Returns the areas of the items of a fence. */
export function fenceAreas(items: readonly Item[]): FenceAreas {
  const areas = { polygons: [] as Polygon[], circles: [] as Circle[], returnPoint: null as Place | null };
  const problems: string[] = [];
  for (let index = 0; index < items.length; ) {
    const first = items[index]!;
    const count = first.command in VERTICES ? vertexCount(items, index) : 1;
    const at = items.slice(index, index + count).map(place);
    if (first.command in VERTICES) {
      if (count >= 3 && count === first.params[0]) {
        areas.polygons.push({ inclusion: VERTICES[first.command]!, vertices: at });
      } else problems.push(`fence item ${index}: ${count} vertices, but param 1 says ${first.params[0]}`);
    } else if (first.command in CIRCLES) {
      const radius = first.params[0] ?? 0;
      areas.circles.push({ inclusion: CIRCLES[first.command]!, center: at[0]!, radius });
    } else if (first.command === CMD.NAV_FENCE_RETURN_POINT) {
      areas.returnPoint = { ...at[0]!, altitude: first.params[6] ?? 0 };
    } else problems.push(`fence item ${index}: command ${first.command} is not a fence item`);
    index += count;
  }
  return { ...areas, problems };
}

/** Returns the number of items of one polygon: at most as many as param 1 says, of one command. */
function vertexCount(items: readonly Item[], from: number): number {
  const first = items[from]!;
  let count = 1;
  while (count < (first.params[0] ?? 1)) {
    const next = items[from + count];
    if (next?.command !== first.command || next.params[0] !== first.params[0]) break;
    count += 1;
  }
  return count;
}

function place(each: Item): { latitude: number; longitude: number } {
  return { latitude: each.params[4] ?? 0, longitude: each.params[5] ?? 0 };
}

function fenceItem(command: number, params: (number | null)[], frame: number = FRAME.GLOBAL): Item {
  return { ...item(command, params, frame), autocontinue: false };
}

export function rallyItems(points: readonly Place[]): Item[] {
  return points.map((at) => {
    const params = [0, 0, 0, 0, at.latitude, at.longitude, at.altitude];
    return fenceItem(CMD.NAV_RALLY_POINT, params, FRAME.GLOBAL_RELATIVE_ALT);
  });
}

export function rallyPoints(items: readonly Item[]): Place[] {
  return items.map((each) => ({ ...place(each), altitude: each.params[6] ?? 0 }));
}
