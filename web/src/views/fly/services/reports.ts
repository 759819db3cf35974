/** Accuracy of the position (RTK) and Remote ID, as the vehicle and its modules report them. */

import { GpsFixType, MavOdidArmStatus } from '$generated';
import type { TextKey } from '$lib/i18n';

export type Fields = Readonly<Record<string, unknown>>;

export interface Fix {
  readonly text: TextKey;
  readonly isPrecise: boolean;
  readonly satellites: number | null;
  /** Metres; null: not reported. */
  readonly horizontal: number | null;
  readonly vertical: number | null;
}

const FIXES: Readonly<Record<number, TextKey>> = {
  [GpsFixType.NO_GPS]: 'payload.fixNoGps',
  [GpsFixType.NO_FIX]: 'payload.fixNone',
  [GpsFixType._2D_FIX]: 'payload.fix2d',
  [GpsFixType._3D_FIX]: 'payload.fix3d',
  [GpsFixType.DGPS]: 'payload.fixDgps',
  [GpsFixType.RTK_FLOAT]: 'payload.fixFloat',
  [GpsFixType.RTK_FIXED]: 'payload.fixFixed',
  [GpsFixType.STATIC]: 'payload.fixStatic',
  [GpsFixType.PPP]: 'payload.fixPpp',
};
const UNKNOWN_SATELLITES = 255;
const MILLIMETRES = 1000;

/** Returns the fix of GPS_RAW_INT or GPS2_RAW. */
export function fixOf(fields: Fields): Fix {
  const type = Number(fields.fix_type ?? 0);
  const satellites = Number(fields.satellites_visible ?? UNKNOWN_SATELLITES);
  const metres = (name: string): number | null =>
    (Number(fields[name] ?? 0) || null) && Number(fields[name]) / MILLIMETRES;
  return {
    text: FIXES[type] ?? 'payload.fixNone',
    isPrecise: type === GpsFixType.RTK_FLOAT || type === GpsFixType.RTK_FIXED,
    satellites: satellites === UNKNOWN_SATELLITES ? null : satellites,
    horizontal: metres('h_acc'),
    vertical: metres('v_acc'),
  };
}

export interface Baseline {
  /** Metres from the base. */
  readonly length: number;
  /** Base measurements a second. */
  readonly rate: number;
  readonly satellites: number;
}

/** Returns the baseline of GPS_RTK or GPS2_RTK. */
export function baselineOf(fields: Fields): Baseline {
  const part = (name: string): number => Number(fields[name] ?? 0) / MILLIMETRES;
  return {
    length: Math.hypot(part('baseline_a_mm'), part('baseline_b_mm'), part('baseline_c_mm')),
    rate: Number(fields.rtk_rate ?? 0),
    satellites: Number(fields.nsats ?? 0),
  };
}

export interface RemoteId {
  readonly isReady: boolean;
  /** Why it does not permit arming; empty: nothing is said. */
  readonly reason: string;
}

/** Returns the state of OPEN_DRONE_ID_ARM_STATUS. */
export function remoteIdOf(fields: Fields): RemoteId {
  const isReady = Number(fields.status) === MavOdidArmStatus.GOOD_TO_ARM;
  return { isReady, reason: String(fields.error ?? '').trim() };
}
