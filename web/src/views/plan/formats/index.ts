/** Plan files: detection, reading and writing. */

import { CMD, EMPTY_PLAN, waypoint, type Plan } from '../logic/model';
import { newItem } from '../logic/commands';
import { Tree } from './json';
import { isKml, readKml, writeKml } from './kml';
import { readMavstack, writeMavstack } from './mavstack';
import { readQgc, writeQgc, type ReadPlan } from './qgc';
import { isWaypoints, readWaypoints, writeWaypoints } from './waypoints';

export { PlanFileError } from './json';
export type { ReadPlan } from './qgc';

export type PlanFormat = 'plan' | 'waypoints' | 'kml' | 'json';

export const FORMATS: Readonly<Record<PlanFormat, { readonly suffix: string; readonly type: string }>> = {
  plan: { suffix: '.plan', type: 'application/json' },
  waypoints: { suffix: '.waypoints', type: 'text/plain' },
  kml: { suffix: '.kml', type: 'application/vnd.google-earth.kml+xml' },
  json: { suffix: '.json', type: 'application/json' },
};
/** The suffixes that a file dialog offers. */
export const SUFFIXES = '.plan,.waypoints,.txt,.mission,.kml,.json';

/** Metres above home of waypoints from a drawn path without altitudes. */
export const DEFAULT_ALTITUDE = 30;

/** Reads a plan file of any format; throws `PlanFileError` with the place of what is wrong. */
export function readPlan(text: string, altitude: number = DEFAULT_ALTITUDE): ReadPlan {
  if (isWaypoints(text)) return readWaypoints(text);
  if (isKml(text)) return { plan: fromKml(text, altitude), notes: [] };
  const root = Tree.parse(text);
  return root.get('fileType').text() === 'MavstackPlan' ? readMavstack(root) : readQgc(root);
}

export function writePlan(plan: Plan, format: PlanFormat, name: string): string {
  if (format === 'plan') return writeQgc(plan);
  if (format === 'waypoints') return writeWaypoints(plan);
  return format === 'kml' ? writeKml(plan, name) : writeMavstack(plan);
}

/** Paths and points become waypoints at one altitude, polygons areas to stay in. */
function fromKml(text: string, altitude: number): Plan {
  const shapes = readKml(text);
  const path = shapes.paths.length ? shapes.paths.flat() : shapes.points;
  const first = path[0];
  const takeoff = first ? [newItem(CMD.NAV_TAKEOFF, { ...first, altitude })] : [];
  const polygons = shapes.polygons.filter((each) => each.length >= 3);
  return {
    ...EMPTY_PLAN,
    mission: [...takeoff, ...path.map((each) => waypoint(each, altitude))],
    polygons: polygons.map((vertices) => ({
      inclusion: true,
      vertices: vertices.map(({ latitude, longitude }) => ({ latitude, longitude })),
    })),
  };
}
