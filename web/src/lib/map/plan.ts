/** Plans as the map draws them: places of mission items, shapes of fences, rally points. Pure functions of items. */
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
  /** DO_JUMP: from the last place before it to the place of its target. */
  readonly jumps: readonly (readonly [Place, Place])[];
}

const KINDS: Readonly<Record<number, StopKind>> = {
  16: 'waypoint',
  17: 'loiter',
  18: 'loiter',
  19: 'loiter',
  20: 'rtl',
  21: 'land',
  22: 'takeoff',
  31: 'loiter',
  82: 'spline',
  84: 'takeoff',
  85: 'land',
  195: 'interest',
  201: 'interest',
};
/** The parameter of loiter commands that holds the radius, counted from 0. */
const RADIUS_PARAMETER: Readonly<Record<number, number>> = { 17: 2, 18: 2, 19: 2, 31: 1 };
const DO_JUMP = 177;

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
    if (item.command === DO_JUMP) {
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

const FENCE_RETURN = 5000;
const POLYGON_IN = 5001;
const POLYGON_OUT = 5002;
const CIRCLE_IN = 5003;
const CIRCLE_OUT = 5004;

/** Return the shapes of a fence; the corners of a polygon are as many items as its first parameter says. */
export function fenceShapes(items: readonly MapItem[]): FenceShape[] {
  const shapes: FenceShape[] = [];
  for (let index = 0; index < items.length; ) {
    const item = items[index]!;
    const place = placeOf(item);
    const [size] = item.params;
    if (item.command === POLYGON_IN || item.command === POLYGON_OUT) {
      const count = Math.max(1, Math.min(items.length - index, size ?? 1));
      const corners = items.slice(index, index + count).map(placeOf);
      const known = corners.filter((corner) => corner !== null);
      shapes.push({ kind: 'polygon', isInclusion: item.command === POLYGON_IN, corners: known });
      index += count;
      continue;
    }
    if (place !== null && (item.command === CIRCLE_IN || item.command === CIRCLE_OUT)) {
      shapes.push({ kind: 'circle', isInclusion: item.command === CIRCLE_IN, centre: place, radius: size ?? 0 });
    } else if (place !== null && item.command === FENCE_RETURN) {
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
