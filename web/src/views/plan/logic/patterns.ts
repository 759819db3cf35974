/** Patterns in a mission: where they are, and their form in QGroundControl's files. */

import { MavCmd, MavFrame } from '$generated';

import type { Json } from '../formats/json';
import { insertItems, removeItems, type Item, type Pattern, type Plan } from './model';
import type { Point } from './geo';
import {
  CAMERAS,
  laneItems,
  PATTERN,
  pictureCount,
  spacingOf,
  type Camera,
  type Lane,
  type PatternSettings,
} from './pattern';

/** Items of a mission that are a pattern. */
export interface PatternRun {
  readonly pattern: Pattern;
  readonly start: number;
  readonly end: number;
}

/** Places on a vehicle are rounded to 1e-7 degrees, other numbers to 32 bits. */
const PLACE_TOLERANCE = 2e-7;
const TOLERANCE = 1e-5;

function isSameNumber(one: number | null, other: number | null, index: number): boolean {
  if (one === null || other === null) return one === other;
  const tolerance = index === 4 || index === 5 ? PLACE_TOLERANCE : TOLERANCE * Math.max(1, Math.abs(one));
  return Math.abs(one - other) <= tolerance;
}

function isSameItem(one: Item, other: Item): boolean {
  if (one.command !== other.command || one.frame !== other.frame || one.autocontinue !== other.autocontinue)
    return false;
  return (
    !one.kept &&
    !other.kept &&
    one.params.every((value, index) => isSameNumber(value, other.params[index] ?? null, index))
  );
}

/** Returns the patterns whose items are in the mission as they were made, in their order. */
export function patternRuns({ mission, patterns }: Pick<Plan, 'mission' | 'patterns'>): PatternRun[] {
  const left = [...patterns];
  const runs: PatternRun[] = [];
  for (let start = 0; start < mission.length && left.length > 0; start += 1) {
    const at = left.findIndex(({ items }) => {
      return (
        items.length > 0 &&
        items.every((item, index) => mission[start + index] && isSameItem(mission[start + index]!, item))
      );
    });
    if (at < 0) continue;
    const [pattern] = left.splice(at, 1);
    runs.push({ pattern: pattern!, start, end: start + pattern!.items.length });
    start += pattern!.items.length - 1;
  }
  return runs;
}

/** Returns the pattern that an item is part of, or null. */
export function patternAt(plan: Pick<Plan, 'mission' | 'patterns'>, index: number): PatternRun | null {
  return patternRuns(plan).find(({ start, end }) => index >= start && index < end) ?? null;
}

/** Returns a plan with the items of another pattern in the place of those of one. */
export function withPattern(plan: Plan, { pattern: before, start }: PatternRun, pattern: Pattern): Plan {
  // The plan may have been changed while the pattern was drawn.
  const run = patternRuns(plan).find((each) => each.pattern === before);
  const indexes = plan.mission.flatMap((_, index) => (run && index >= run.start && index < run.end ? [index] : []));
  const cleared = removeItems(plan, new Set(indexes));
  const at = Math.min(run?.start ?? start, cleared.mission.length);
  return {
    ...insertItems(cleared, at, pattern.items),
    patterns: [...plan.patterns.filter((each) => each !== before), pattern],
  };
}

/** All that a survey or a corridor is made of. */
export interface PatternShape {
  readonly tool: 'survey' | 'corridor';
  /** The corners of the area, or the points of the line. */
  readonly points: readonly Point[];
  /** Heading of the lanes of a survey. */
  readonly angle: number;
  readonly start: number;
  readonly altitude: number;
  readonly frame: number;
  readonly settings: PatternSettings;
}

const KINDS = { survey: 'survey', corridor: 'CorridorScan' } as const;
/** QGroundControl's names for a camera that it does not know, and for none. */
const CUSTOM_CAMERA = 'Custom Camera';
const NO_CAMERA = 'Manual (no camera specs)';
/** QGroundControl counts the corners from the top left one, the page from the bottom left one. */
const CORNER = 2;

/** Returns the pattern of a shape and the items that fly it. */
export function patternOf(shape: PatternShape, lanes: readonly Lane[]): Pattern {
  const { tool, points, settings, altitude, frame } = shape;
  const pair = ({ latitude, longitude }: Point): Json => [latitude, longitude];
  const camera = CAMERAS.find(({ name }) => name === settings.camera) ?? null;
  const spacing = camera
    ? spacingOf(camera, altitude, settings)
    : { lanes: settings.spacing, pictures: settings.pictures };
  const items = laneItems(lanes, { altitude, frame, pictures: spacing.pictures, turnaround: settings.turnaround });
  const places = items.filter(({ command }) => command === MavCmd.NAV_WAYPOINT);
  const style = {
    CameraCalc: cameraJson(shape, camera, spacing),
    CameraShots: pictureCount(lanes, spacing.pictures),
    CameraTriggerInTurnAround: false,
    FollowTerrain: false,
    HoverAndCapture: false,
    Refly90Degrees: tool === 'survey' && settings.crosshatch,
    TurnAroundDistance: settings.turnaround,
    VisualTransectPoints: places.map(({ params }) => [params[4] ?? 0, params[5] ?? 0]),
    version: 1,
  };
  const own: Readonly<Record<string, Json>> =
    tool === 'survey'
      ? {
          angle: shape.angle,
          entryLocation: shape.start ^ CORNER,
          flyAlternateTransects: false,
          polygon: points.map(pair),
          splitConcavePolygons: false,
          version: 5,
        }
      : {
          CorridorWidth: settings.width,
          EntryPoint: shape.start > 0 ? CORNER : 0,
          polyline: points.map(pair),
          version: 2,
        };
  const json = { TransectStyleComplexItem: style, complexItemType: KINDS[tool], type: 'ComplexItem', ...own };
  return { kind: KINDS[tool], json, items };
}

function cameraJson(
  { altitude, frame, settings }: PatternShape,
  camera: Camera | null,
  spacing: { lanes: number; pictures: number },
): Json {
  const common = {
    AdjustedFootprintFrontal: spacing.pictures,
    AdjustedFootprintSide: spacing.lanes,
    DistanceToSurface: altitude,
    DistanceToSurfaceRelative: frame !== MavFrame.GLOBAL,
    version: 1,
  };
  if (camera === null) return { CameraName: NO_CAMERA, ...common };
  return {
    CameraName: CUSTOM_CAMERA,
    ...common,
    FixedOrientation: false,
    FocalLength: camera.focalLength,
    FrontalOverlap: settings.front,
    ImageDensity: spacingOf(camera, altitude, settings).resolution,
    ImageHeight: camera.imageHeight,
    ImageWidth: camera.imageWidth,
    Landscape: true,
    MinTriggerInterval: 0,
    SensorHeight: camera.sensorHeight,
    SensorWidth: camera.sensorWidth,
    SideOverlap: settings.side,
    ValueSetIsDistance: true,
  };
}

/** Returns the shape of a pattern, so that it can be drawn again with other settings; null: the page cannot. */
export function shapeOf({ kind, json, items }: Pattern): PatternShape | null {
  const style = record(json.TransectStyleComplexItem);
  const camera = record(style.CameraCalc);
  const tool = kind === KINDS.survey ? 'survey' : kind === KINDS.corridor ? 'corridor' : null;
  const points = placesOf(json[tool === 'survey' ? 'polygon' : 'polyline']);
  const altitude = numberIn(camera, 'DistanceToSurface', NaN);
  if (tool === null || points.length < 2 || !Number.isFinite(altitude)) return null;
  const known = CAMERAS.find((each) => isSameCamera(each, camera));
  const settings: PatternSettings = {
    camera: known?.name ?? '',
    side: numberIn(camera, 'SideOverlap', PATTERN.side),
    front: numberIn(camera, 'FrontalOverlap', PATTERN.front),
    spacing: numberIn(camera, 'AdjustedFootprintSide', PATTERN.spacing),
    pictures: numberIn(camera, 'AdjustedFootprintFrontal', 0),
    turnaround: numberIn(style, 'TurnAroundDistance', PATTERN.turnaround),
    crosshatch: style.Refly90Degrees === true,
    width: numberIn(json, 'CorridorWidth', PATTERN.width),
  };
  const frame = items.find(({ command }) => command === MavCmd.NAV_WAYPOINT)?.frame ?? MavFrame.GLOBAL_RELATIVE_ALT;
  const start =
    tool === 'survey'
      ? numberIn(json, 'entryLocation', CORNER) ^ CORNER
      : Number(numberIn(json, 'EntryPoint', 0) >= CORNER);
  return { tool, points, angle: numberIn(json, 'angle', 0), start, altitude, frame, settings };
}

function isSameCamera(camera: Camera, json: Readonly<Record<string, Json>>): boolean {
  const pairs = [
    [camera.sensorWidth, 'SensorWidth'],
    [camera.sensorHeight, 'SensorHeight'],
    [camera.focalLength, 'FocalLength'],
    [camera.imageWidth, 'ImageWidth'],
    [camera.imageHeight, 'ImageHeight'],
  ] as const;
  // Pictures of a camera that is turned have another side across the flight.
  return json.Landscape !== false && pairs.every(([value, key]) => Math.abs(value - numberIn(json, key, NaN)) < 0.01);
}

function record(value: Json | undefined): Readonly<Record<string, Json>> {
  return value !== null && typeof value === 'object' && !Array.isArray(value)
    ? (value as Readonly<Record<string, Json>>)
    : {};
}

function numberIn(of: Readonly<Record<string, Json>>, key: string, missing: number): number {
  const value = of[key];
  return typeof value === 'number' && Number.isFinite(value) ? value : missing;
}

function placesOf(value: Json | undefined): Point[] {
  if (!Array.isArray(value)) return [];
  return (value as readonly Json[]).flatMap((each) => {
    const [latitude, longitude] = Array.isArray(each) ? (each as readonly Json[]) : [];
    return typeof latitude === 'number' && typeof longitude === 'number' ? [{ latitude, longitude }] : [];
  });
}
