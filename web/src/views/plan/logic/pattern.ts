/** Lanes over an area or along a line, as cameras need them: the geometry that survey and corridor share. */

import { MavCmd, MavFrame } from '$generated';

import { item, waypoint, type Item } from './model';
import { bearing, destination, pathLength, type Point } from './geo';

export interface Camera {
  readonly name: string;
  /** Millimetres. */
  readonly sensorWidth: number;
  readonly sensorHeight: number;
  readonly focalLength: number;
  /** Pixels. */
  readonly imageWidth: number;
  readonly imageHeight: number;
}

export const CAMERAS: readonly Camera[] = [
  { name: 'Sony RX1R II', sensorWidth: 35.9, sensorHeight: 24, focalLength: 35, imageWidth: 7952, imageHeight: 5304 },
  {
    name: 'Sony a6000 16 mm',
    sensorWidth: 23.5,
    sensorHeight: 15.6,
    focalLength: 16,
    imageWidth: 6000,
    imageHeight: 4000,
  },
  {
    name: 'DJI Mavic 3E wide',
    sensorWidth: 17.3,
    sensorHeight: 13,
    focalLength: 12.29,
    imageWidth: 5280,
    imageHeight: 3956,
  },
  {
    name: 'GoPro Hero 4',
    sensorWidth: 6.17,
    sensorHeight: 4.55,
    focalLength: 2.98,
    imageWidth: 4000,
    imageHeight: 3000,
  },
  {
    name: 'MicaSense RedEdge',
    sensorWidth: 4.8,
    sensorHeight: 3.6,
    focalLength: 5.5,
    imageWidth: 1280,
    imageHeight: 960,
  },
];

export interface Overlap {
  /** Percent of the picture between lanes, and between pictures of a lane. */
  readonly side: number;
  readonly front: number;
}

export interface Spacing {
  /** Metres between lanes, and between pictures. */
  readonly lanes: number;
  readonly pictures: number;
  /** Metres on the ground across and along the flight. */
  readonly footprint: { readonly across: number; readonly along: number };
  /** Centimetres on the ground of a pixel. */
  readonly resolution: number;
}

/** Returns the spacing at an altitude in metres above ground; the long side of the picture is across the flight. */
export function spacingOf(camera: Camera, altitude: number, overlap: Overlap): Spacing {
  const across = (altitude * camera.sensorWidth) / camera.focalLength;
  const along = (altitude * camera.sensorHeight) / camera.focalLength;
  return {
    lanes: across * (1 - overlap.side / 100),
    pictures: along * (1 - overlap.front / 100),
    footprint: { across, along },
    resolution: (across * 100) / camera.imageWidth,
  };
}

/** Returns the altitude in metres at which a pixel covers so many centimetres. */
export function altitudeFor(camera: Camera, resolution: number): number {
  return (resolution * camera.imageWidth * camera.focalLength) / (100 * camera.sensorWidth);
}

/** The points of a lane: two, or more where it follows a line. */
export type Lane = readonly Point[];

export interface FlightOptions {
  /** Metres above home. */
  readonly altitude: number;
  readonly frame?: number;
  /** Metres between pictures; 0 takes none. */
  readonly pictures: number;
  /** Metres that the vehicle flies on behind a lane, to turn outside of the area. */
  readonly turnaround: number;
}

/** The largest number of lanes of a pattern, beyond which its spacing is certainly wrong. */
export const MAX_LANES = 1000;
/** The settings of a pattern. */
export interface PatternSettings {
  /** Name of the camera; empty: the distance of lanes is given by hand. */
  readonly camera: string;
  readonly side: number;
  readonly front: number;
  readonly spacing: number;
  /** Metres between pictures without a camera; 0 takes none. */
  readonly pictures: number;
  readonly turnaround: number;
  readonly crosshatch: boolean;
  /** Metres of a corridor. */
  readonly width: number;
}

/** The settings of the first pattern. */
export const PATTERN: PatternSettings = {
  camera: 'Sony a6000 16 mm',
  side: 70,
  front: 75,
  spacing: 25,
  pictures: 0,
  turnaround: 10,
  crosshatch: false,
  width: 60,
};

/** The part of a lane's width that may stay uncovered, so that rounding adds no lane. */
export const TOLERANCE = 1e-3;

/** Returns the items that fly lanes one after the other and take pictures on them. */
export function laneItems(lanes: readonly Lane[], options: FlightOptions): Item[] {
  const { altitude, pictures, turnaround } = options;
  const frame = options.frame ?? MavFrame.GLOBAL_RELATIVE_ALT;
  const at = (point: Point): Item => waypoint(point, altitude, frame);
  const trigger = (metres: number): Item[] =>
    pictures > 0 ? [item(MavCmd.DO_SET_CAM_TRIGG_DIST, [metres, 0, metres > 0 ? 1 : 0], MavFrame.MISSION)] : [];
  return lanes.flatMap((lane) => {
    const [first, second] = lane;
    const [beforeLast, last] = [lane.at(-2), lane.at(-1)];
    if (!first || !second || !beforeLast || !last) return [];
    const [before, after] = [extended(second, first, turnaround), extended(beforeLast, last, turnaround)];
    const turn = (point: Point): Item[] => (turnaround > 0 ? [at(point)] : []);
    return [...turn(before), at(first), ...trigger(pictures), ...lane.slice(1).map(at), ...trigger(0), ...turn(after)];
  });
}

/** Returns the point that lies beyond `to` by some metres. */
export function extended(from: Point, to: Point, metres: number): Point {
  return destination(to, bearing(from, to), metres);
}

/** Returns the numbers of a pattern, null without lanes; `area` in square metres. */
export function summaryOf(
  lanes: readonly Lane[],
  pictures: number,
  area: number,
): { lanes: number; distance: number; pictures: number; area: number } | null {
  if (lanes.length === 0) return null;
  const distance = lanes.reduce((sum, lane) => sum + pathLength(lane), 0);
  return { lanes: lanes.length, distance, pictures: pictureCount(lanes, pictures), area };
}

/** Returns the number of pictures on the lanes. */
export function pictureCount(lanes: readonly Lane[], pictures: number): number {
  if (pictures <= 0) return 0;
  return lanes.reduce((sum, lane) => sum + Math.floor(pathLength(lane) / pictures) + 1, 0);
}
