/** Fence areas as the mission items that vehicles hold, and back. */

import { MavCmd, MavFrame } from '$generated';

import { item, type Circle, type Item, type Place, type Polygon } from './model';

export interface FenceAreas {
  readonly polygons: readonly Polygon[];
  readonly circles: readonly Circle[];
  readonly returnPoint: Place | null;
  /** Items that are no area. */
  readonly problems: readonly string[];
}

const VERTICES: Readonly<Record<number, boolean>> = {
  [MavCmd.NAV_FENCE_POLYGON_VERTEX_INCLUSION]: true,
  [MavCmd.NAV_FENCE_POLYGON_VERTEX_EXCLUSION]: false,
};
const CIRCLES: Readonly<Record<number, boolean>> = {
  [MavCmd.NAV_FENCE_CIRCLE_INCLUSION]: true,
  [MavCmd.NAV_FENCE_CIRCLE_EXCLUSION]: false,
};

/** Returns the items of a fence: polygons, circles, return point. */
export function fenceItems(areas: Omit<FenceAreas, 'problems'>): Item[] {
  const polygons = areas.polygons.flatMap((polygon) => {
    const command = polygon.inclusion
      ? MavCmd.NAV_FENCE_POLYGON_VERTEX_INCLUSION
      : MavCmd.NAV_FENCE_POLYGON_VERTEX_EXCLUSION;
    const count = polygon.vertices.length;
    return polygon.vertices.map((at) =>
      fenceItem(command, [count, polygon.group ?? 0, 0, 0, at.latitude, at.longitude, 0]),
    );
  });
  const circles = areas.circles.map(({ inclusion, center, radius, group }) => {
    const command = inclusion ? MavCmd.NAV_FENCE_CIRCLE_INCLUSION : MavCmd.NAV_FENCE_CIRCLE_EXCLUSION;
    return fenceItem(command, [radius, group ?? 0, 0, 0, center.latitude, center.longitude, 0]);
  });
  const home = areas.returnPoint;
  const params = home && [0, 0, 0, 0, home.latitude, home.longitude, home.altitude];
  const last = params
    ? [fenceItem(MavCmd.NAV_FENCE_RETURN_POINT, params, home!.frame ?? MavFrame.GLOBAL_RELATIVE_ALT)]
    : [];
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
        areas.polygons.push({ inclusion: VERTICES[first.command]!, vertices: at, ...groupOf(first) });
      } else problems.push(`fence item ${index}: ${count} vertices, but param 1 says ${first.params[0]}`);
    } else if (first.command in CIRCLES) {
      const radius = first.params[0] ?? 0;
      areas.circles.push({ inclusion: CIRCLES[first.command]!, center: at[0]!, radius, ...groupOf(first) });
    } else if (first.command === MavCmd.NAV_FENCE_RETURN_POINT) {
      areas.returnPoint = placeOf(first);
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
    if (next?.command !== first.command || next.params[0] !== first.params[0] || next.params[1] !== first.params[1])
      break;
    count += 1;
  }
  return count;
}

function place(each: Item): { latitude: number; longitude: number } {
  return { latitude: each.params[4] ?? 0, longitude: each.params[5] ?? 0 };
}

/** Returns the point of an item with its altitude, and its frame if that is not relative to home. */
function placeOf(each: Item): Place {
  const found = { ...place(each), altitude: each.params[6] ?? 0 };
  return each.frame === MavFrame.GLOBAL_RELATIVE_ALT ? found : { ...found, frame: each.frame };
}

function groupOf(each: Item): { group?: number } {
  return each.params[1] ? { group: each.params[1] } : {};
}

function fenceItem(command: number, params: (number | null)[], frame: number = MavFrame.GLOBAL): Item {
  return { ...item(command, params, frame), autocontinue: false };
}

export function rallyItems(points: readonly Place[]): Item[] {
  return points.map((at) => {
    const params = [0, 0, 0, 0, at.latitude, at.longitude, at.altitude];
    return fenceItem(MavCmd.NAV_RALLY_POINT, params, at.frame ?? MavFrame.GLOBAL_RELATIVE_ALT);
  });
}

export function rallyPoints(items: readonly Item[]): Place[] {
  return items.map(placeOf);
}
