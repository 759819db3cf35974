/** Distances that a vehicle measures: single sensors (DISTANCE_SENSOR) and all around it (OBSTACLE_DISTANCE). */

import { MavFrame, MavSensorOrientation } from '$generated';
import type { DecodedMessage } from '$lib/decoder/Decoder';

const NO_DISTANCE = 0xffff;
const CENTIMETRES = 100;

export type Direction = 'forward' | 'right' | 'back' | 'left' | 'up' | 'down' | 'other';

export interface Range {
  readonly id: number;
  readonly direction: Direction;
  /** Degrees from the nose for a level sensor, or null. */
  readonly bearing: number | null;
  /** In m; null: nothing in reach. */
  readonly distance: number | null;
  /** Largest distance that it measures, in m. */
  readonly reach: number;
}

/** A part of the circle around a vehicle. */
export interface Sector {
  /** Middle, in degrees clockwise from the nose. */
  readonly bearing: number;
  /** In degrees. */
  readonly width: number;
  /** In m; null: nothing in reach, or not measured. */
  readonly distance: number | null;
}

export interface Surroundings {
  readonly sectors: readonly Sector[];
  readonly reach: number;
}

/** Level orientations are the first eight, each 45° further to the right. */
const LEVEL = 8;
const DIRECTIONS: Readonly<Record<number, Direction>> = {
  [MavSensorOrientation.YAW_315]: 'forward',
  [MavSensorOrientation.NONE]: 'forward',
  [MavSensorOrientation.YAW_45]: 'forward',
  [MavSensorOrientation.YAW_90]: 'right',
  [MavSensorOrientation.YAW_135]: 'back',
  [MavSensorOrientation.YAW_180]: 'back',
  [MavSensorOrientation.YAW_225]: 'back',
  [MavSensorOrientation.YAW_270]: 'left',
  [MavSensorOrientation.PITCH_90]: 'up',
  [MavSensorOrientation.PITCH_270]: 'down',
};

/** Returns the measurement of a DISTANCE_SENSOR. */
export function rangeOf({ fields }: Pick<DecodedMessage, 'fields'>): Range {
  const [orientation, measured, limit] = [fields.orientation, fields.current_distance, fields.max_distance].map(Number);
  const isNothing = measured! >= limit! || measured === NO_DISTANCE;
  return {
    id: Number(fields.id),
    direction: DIRECTIONS[orientation!] ?? 'other',
    bearing: orientation! < LEVEL ? orientation! * 45 : null,
    distance: isNothing ? null : measured! / CENTIMETRES,
    reach: limit! / CENTIMETRES,
  };
}

/**
 * Returns the sectors of an OBSTACLE_DISTANCE, relative to the nose.
 *
 * @param heading - Of the vehicle, for sectors that are counted from north.
 */
export function surroundingsOf({ fields }: Pick<DecodedMessage, 'fields'>, heading: number): Surroundings {
  const distances = fields.distances as readonly number[];
  const limit = Number(fields.max_distance);
  const width = Number(fields.increment_f) || Number(fields.increment);
  const offset = Number(fields.angle_offset) - (Number(fields.frame) === MavFrame.BODY_FRD ? 0 : heading);
  const step = Math.abs(width);
  const count = step > 0 ? Math.min(distances.length, Math.round(360 / step)) : 0;
  const sectors = Array.from({ length: count }, (_, index) => {
    const measured = distances[index]!;
    return {
      bearing: (((offset + index * width) % 360) + 360) % 360,
      width: step,
      distance: measured >= limit || measured === NO_DISTANCE ? null : measured / CENTIMETRES,
    };
  });
  return { sectors, reach: limit / CENTIMETRES };
}

/** Returns the smallest distance, or null if nothing is in reach. */
export function nearestOf(ranges: readonly Range[], around: Surroundings | null): number | null {
  const level = ranges.filter(({ bearing }) => bearing !== null);
  const all = [...level, ...(around?.sectors ?? [])].flatMap(({ distance }) => (distance === null ? [] : [distance]));
  return all.length === 0 ? null : Math.min(...all);
}

/** Returns the path of a sector of an SVG picture with the radius 1; its nose is at the top. */
export function sectorPath({ bearing, width }: Sector, inner: number, outer: number): string {
  const at = (degrees: number, radius: number): string => {
    const angle = ((degrees - 90) * Math.PI) / 180;
    return `${(Math.cos(angle) * radius).toFixed(4)} ${(Math.sin(angle) * radius).toFixed(4)}`;
  };
  const [from, to] = [bearing - width / 2, bearing + width / 2];
  const large = width > 180 ? 1 : 0;
  return (
    `M${at(from, inner)}L${at(from, outer)}A${outer} ${outer} 0 ${large} 1 ${at(to, outer)}` +
    `L${at(to, inner)}A${inner} ${inner} 0 ${large} 0 ${at(from, inner)}Z`
  );
}
