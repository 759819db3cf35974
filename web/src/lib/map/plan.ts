/** Plans as the map draws them: places of mission items, shapes of fences, rally points. Pure functions of items. */
import { MavCmd } from '$generated';

import type { Place } from './geometry';

/** The part of a mission item that has a meaning on the map. */
export interface MapItem {
  readonly seq: number;
  /** MAV_CMD. */
  readonly command: number;
  /** Seven parameters, latitude and longitude in degrees. */
  readonly params: readonly (number | null)[];
  readonly frame?: number;
}

export type StopKind = 'waypoint' | 'takeoff' | 'land' | 'loiter' | 'spline' | 'rtl' | 'interest';

export interface Stop extends Place {
  readonly seq: number;
  readonly kind: StopKind;
  /** In metres as the frame of the item counts them. */
  readonly altitude: number | null;
  /** In metres, of loiter circles; negative is counter-clockwise. */
  readonly radius: number | null;
}

export interface MissionPath {
  /** Places in the order of flight, also those that are only looked at. */
  readonly stops: readonly Stop[];
  /** The line that is flown. */
  readonly line: readonly Place[];
  /** MavCmd.DO_JUMP: from the last place before it to the place of its target. */
  readonly jumps: readonly (readonly [Place, Place])[];
}

const KINDS: Readonly<Record<number, StopKind>> = {
  [MavCmd.NAV_WAYPOINT]: 'waypoint',
  [MavCmd.NAV_LOITER_UNLIM]: 'loiter',
  [MavCmd.NAV_LOITER_TURNS]: 'loiter',
  [MavCmd.NAV_LOITER_TIME]: 'loiter',
  [MavCmd.NAV_RETURN_TO_LAUNCH]: 'rtl',
  [MavCmd.NAV_LAND]: 'land',
  [MavCmd.NAV_TAKEOFF]: 'takeoff',
  [MavCmd.NAV_LOITER_TO_ALT]: 'loiter',
  [MavCmd.NAV_SPLINE_WAYPOINT]: 'spline',
  [MavCmd.NAV_VTOL_TAKEOFF]: 'takeoff',
  [MavCmd.NAV_VTOL_LAND]: 'land',
  [MavCmd.DO_SET_ROI_LOCATION]: 'interest',
  [MavCmd.DO_SET_ROI]: 'interest',
};
/** The parameter of loiter commands that holds the radius, counted from 0. */
const RADIUS_PARAMETER: Readonly<Record<number, number>> = {
  [MavCmd.NAV_LOITER_UNLIM]: 2,
  [MavCmd.NAV_LOITER_TURNS]: 2,
  [MavCmd.NAV_LOITER_TIME]: 2,
  [MavCmd.NAV_LOITER_TO_ALT]: 1,
};

function placeOf(item: MapItem): Place | null {
  const [latitude, longitude] = [item.params[4] ?? 0, item.params[5] ?? 0];
  return latitude === 0 && longitude === 0 ? null : { latitude, longitude };
}

/** Return the places and lines of a mission; items without a place of their own stay where the one before was. */
export function missionPath(items: readonly MapItem[], home: Place | null): MissionPath {
  const stops: Stop[] = [];
  const line: Place[] = [];
  const jumps: (readonly [Place, Place])[] = [];
  const places = new Map<number, Place>();
  let here = home;
  for (const item of items) {
    const kind = KINDS[item.command];
    if (item.command === MavCmd.DO_JUMP) {
      const target = places.get(item.params[0] ?? -1);
      if (here !== null && target !== undefined) jumps.push([here, target]);
      continue;
    }
    if (kind === undefined) continue;
    const place = kind === 'rtl' ? home : (placeOf(item) ?? here);
    if (place === null) continue;
    const radius = item.params[RADIUS_PARAMETER[item.command] ?? -1] ?? null;
    stops.push({ ...pick(place), seq: item.seq + 1, kind, altitude: item.params[6] ?? null, radius });
    places.set(item.seq, place);
    if (kind === 'interest') continue;
    if (line.length === 0 && kind === 'takeoff' && home !== null) line.push(pick(home));
    line.push(pick(place));
    here = place;
  }
  return { stops, line, jumps };
}

function pick({ latitude, longitude }: Place): Place {
  return { latitude, longitude };
}

export type FenceShape =
  | { readonly kind: 'polygon'; readonly isInclusion: boolean; readonly corners: readonly Place[] }
  | { readonly kind: 'circle'; readonly isInclusion: boolean; readonly centre: Place; readonly radius: number }
  | { readonly kind: 'return'; readonly place: Place };

/** Return the shapes of a fence; the corners of a polygon are as many items as its first parameter says. */
export function fenceShapes(items: readonly MapItem[]): FenceShape[] {
  const shapes: FenceShape[] = [];
  for (let index = 0; index < items.length; ) {
    const item = items[index]!;
    const place = placeOf(item);
    const [size] = item.params;
    if (
      item.command === MavCmd.NAV_FENCE_POLYGON_VERTEX_INCLUSION ||
      item.command === MavCmd.NAV_FENCE_POLYGON_VERTEX_EXCLUSION
    ) {
      const count = Math.max(1, Math.min(items.length - index, size ?? 1));
      const corners = items.slice(index, index + count).map(placeOf);
      const known = corners.filter((corner) => corner !== null);
      shapes.push({
        kind: 'polygon',
        isInclusion: item.command === MavCmd.NAV_FENCE_POLYGON_VERTEX_INCLUSION,
        corners: known,
      });
      index += count;
      continue;
    }
    if (
      place !== null &&
      (item.command === MavCmd.NAV_FENCE_CIRCLE_INCLUSION || item.command === MavCmd.NAV_FENCE_CIRCLE_EXCLUSION)
    ) {
      shapes.push({
        kind: 'circle',
        isInclusion: item.command === MavCmd.NAV_FENCE_CIRCLE_INCLUSION,
        centre: place,
        radius: size ?? 0,
      });
    } else if (place !== null && item.command === MavCmd.NAV_FENCE_RETURN_POINT) {
      shapes.push({ kind: 'return', place });
    }
    index += 1;
  }
  return shapes;
}

/** Return the rally points of a plan. */
export function rallyPlaces(items: readonly MapItem[]): Place[] {
  return items.map(placeOf).filter((place) => place !== null);
}
