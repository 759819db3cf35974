/** Plan files: detection, reading and writing. */

import { MavCmd } from '$generated';

import { EMPTY_PLAN, isEmpty, waypoint, type Plan } from '../logic/model';
import { newItem } from '../logic/commands';
import { patternRuns } from '../logic/patterns';
import { PlanFileError, Tree } from './json';
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

/** A larger file is no plan. */
const MAX_BYTES = 64 * 1024 * 1024;
/** The first bytes of a ZIP archive, such as a .kmz. */
const ZIP = 'PK\u0003\u0004';

/** Reads the plan of a file; throws `PlanFileError` with what is wrong. */
export async function readFile(file: File, altitude: number): Promise<ReadPlan> {
  if (file.size > MAX_BYTES) throw new PlanFileError(`${file.size} bytes are too many for a plan`);
  return readPlan(await file.text(), altitude);
}

/** Returns whether a format holds all that a plan has. */
export function holdsAll(plan: Plan, format: PlanFormat): boolean {
  if (format === 'plan') return !hasMoreThanQgc(plan);
  const hasKept = plan.mission.some((each) => each.kept) || patternRuns(plan).length > 0;
  if (format === 'json') return !hasKept;
  return format === 'waypoints' && !hasKept && isEmpty(plan, 'fence') && isEmpty(plan, 'rally');
}

/** QGroundControl's files have no inclusion groups, and altitudes of points are relative to home. */
function hasMoreThanQgc({ polygons, circles, rally, returnPoint }: Plan): boolean {
  return (
    [...polygons, ...circles].some((each) => each.group) ||
    [...rally, returnPoint].some((each) => each?.frame !== undefined)
  );
}

/** Reads a plan file of any format; throws `PlanFileError` with the place of what is wrong. */
export function readPlan(given: string, altitude: number = DEFAULT_ALTITUDE): ReadPlan {
  const text = given.replace(/^\uFEFF/, '').replace(/\r\n?/g, '\n');
  if (text.startsWith(ZIP))
    throw new PlanFileError('the file is an archive: unpack it first, and open the .kml or .plan inside');
  if (isWaypoints(text)) return readWaypoints(text);
  if (isKml(text)) return { plan: fromKml(text, altitude), notes: [] };
  if (!/^\s*[{[]/.test(text)) throw new PlanFileError('the file is no plan: neither JSON, QGC WPL nor KML');
  const root = Tree.parse(text);
  if (root.value === null || typeof root.value !== 'object' || Array.isArray(root.value))
    throw root.wrong('is not a plan');
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
  const takeoff = first ? [newItem(MavCmd.NAV_TAKEOFF, { ...first, altitude })] : [];
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
