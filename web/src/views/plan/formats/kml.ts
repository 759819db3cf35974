/** KML: a plan as Google Earth shows it, and drawn paths and areas as it saves them. */

import { MavFrame } from '$generated';

import { withoutKept, type Place, type Plan } from '../logic/model';
import { destination, type Point } from '../logic/geo';
import { itemPosition, commandInfo } from '../logic/commands';
import { pathOf } from '../logic/path';
import { PlanFileError } from './json';

/** The shapes of a file; altitudes are those of the file, 0 where it has none. */
export interface KmlShapes {
  readonly paths: readonly (readonly Place[])[];
  readonly polygons: readonly (readonly Place[])[];
  readonly points: readonly Place[];
}

const CIRCLE_POINTS = 36;
const MODES: Readonly<Record<number, string>> = {
  [MavFrame.GLOBAL]: 'absolute',
  [MavFrame.GLOBAL_TERRAIN_ALT]: 'relativeToGround',
};

export function isKml(text: string): boolean {
  return /<kml[\s>]/.test(text.slice(0, 4096));
}

/** Returns a plan as KML: its path, items, fence and rally points. */
export function writeKml(whole: Plan, name: string): string {
  const plan = withoutKept(whole);
  const path = pathOf(plan);
  const line = path.map((each) => [each.longitude, each.latitude, each.altitude].join(',')).join(' ');
  const mode = modeOf(path.at(-1)?.frame);
  const parts = [
    ...(path.length > 1
      ? [
          placemark(
            'Path',
            `<LineString><tessellate>1</tessellate>${mode}<coordinates>${line}</coordinates></LineString>`,
          ),
        ]
      : []),
    ...plan.mission.flatMap((each, index) => {
      const at = itemPosition(each);
      const label = `${index + 1} ${commandInfo(each.command).label}`;
      return at ? [placemark(label, point({ ...at, altitude: each.params[6] ?? 0 }, modeOf(each.frame)))] : [];
    }),
    ...plan.polygons.map((each) => area(each.vertices, each.inclusion)),
    ...plan.circles.map((each) => area(circle(each.center, each.radius), each.inclusion)),
    ...plan.rally.map((each, index) => placemark(`Rally point ${index + 1}`, point(each, modeOf(undefined)))),
  ];
  const body = [`<name>${escaped(name)}</name>`, ...parts].map((each) => `    ${each}\n`).join('');
  const head = '<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2">\n';
  return `${head}  <Document>\n${body}  </Document>\n</kml>\n`;
}

function modeOf(frame: number | undefined): string {
  return `<altitudeMode>${MODES[frame ?? MavFrame.GLOBAL_RELATIVE_ALT] ?? 'relativeToGround'}</altitudeMode>`;
}

function point(at: Place, mode: string): string {
  return `<Point>${mode}<coordinates>${at.longitude},${at.latitude},${at.altitude}</coordinates></Point>`;
}

function area(vertices: readonly Point[], inclusion: boolean): string {
  const ring = [...vertices, ...vertices.slice(0, 1)].map((each) => `${each.longitude},${each.latitude},0`).join(' ');
  const line = `<LinearRing><coordinates>${ring}</coordinates></LinearRing>`;
  const shape = `<Polygon><outerBoundaryIs>${line}</outerBoundaryIs></Polygon>`;
  return placemark(inclusion ? 'Fence: stay in' : 'Fence: stay out', shape);
}

function circle(center: Point, radius: number): Point[] {
  return Array.from({ length: CIRCLE_POINTS }, (_, index) =>
    destination(center, (index * 360) / CIRCLE_POINTS, radius),
  );
}

function placemark(name: string, geometry: string): string {
  return `<Placemark><name>${escaped(name)}</name>${geometry}</Placemark>`;
}

function escaped(text: string): string {
  return text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;');
}

/** Reads the shapes of a file; throws `PlanFileError` if there is none. */
export function readKml(text: string): KmlShapes {
  const shapes = { paths: all(text, 'LineString'), polygons: all(text, 'Polygon'), points: all(text, 'Point').flat() };
  if (shapes.paths.length + shapes.polygons.length + shapes.points.length === 0) {
    throw new PlanFileError('the file has no path, polygon or point');
  }
  const open = shapes.polygons.map((ring) => (same(ring[0], ring.at(-1)) ? ring.slice(0, -1) : ring));
  return { ...shapes, polygons: open };
}

/** Returns the first coordinates in each element of a name; those of a polygon's holes come later. */
function all(text: string, element: string): Place[][] {
  const found = [...text.matchAll(new RegExp(`<${element}[\\s>]([\\s\\S]*?)</${element}>`, 'g'))];
  return found.map((match) => coordinates(/<coordinates[^>]*>([\s\S]*?)<\/coordinates>/.exec(match[1]!)?.[1] ?? ''));
}

function coordinates(text: string): Place[] {
  return text
    .trim()
    .split(/\s+/)
    .filter(Boolean)
    .map((word) => {
      const [longitude, latitude, altitude] = word.split(',').map(Number);
      // NaN is no place of the earth either.
      if (!(Math.abs(longitude ?? NaN) <= 180) || !(Math.abs(latitude ?? NaN) <= 90)) {
        throw new PlanFileError(`${word.slice(0, 60)} is not a longitude and a latitude`);
      }
      return { latitude: latitude!, longitude: longitude!, altitude: Number.isFinite(altitude) ? altitude! : 0 };
    });
}

function same(a: Place | undefined, b: Place | undefined): boolean {
  return a !== b && a?.latitude === b?.latitude && a?.longitude === b?.longitude;
}
