/**
 * Whether a vehicle flies: by its landed state, and by its heartbeat and its motion where it sends none.
 *
 * The landed state and ArduPilot's heartbeat are judged as in `mavstack.vehicle` (telemetry/readers/state.py). Motion
 * is the evidence of other firmwares, and of a heartbeat that tells a failsafe instead.
 */

import { MavLandedState, MavState } from '$generated';

import type { VehicleState, VehicleType } from './Vehicle';

type Evidence = Pick<
  VehicleState,
  | 'type'
  | 'firmware'
  | 'armed'
  | 'systemStatus'
  | 'landedState'
  | 'position'
  | 'airSpeed'
  | 'groundSpeed'
  | 'climbRate'
  | 'throttle'
>;

/** A landed state in ms that counts more than the heartbeat. */
const MAX_AGE = 15_000;
/** Types that never leave the ground or the water. */
export const ON_SURFACE: ReadonlySet<VehicleType> = new Set(['rover', 'boat', 'sub', 'tracker']);
/** So fast in m/s that a wing flies, if it is also so high in m above home or climbs or sinks so fast. */
const FLYING_SPEED = 7;
const FLYING_HEIGHT = 5;
const FLYING_CLIMB = 1;
const FLYING_THROTTLE = 0.15;

/**
 * Returns whether a vehicle flies; null: nothing tells.
 *
 * @param landedAge - Age of the landed state in ms.
 */
export function isInAir(state: Evidence, landedAge: number): boolean | null {
  if (ON_SURFACE.has(state.type)) return false;
  const landed = state.landedState === null ? null : state.landedState !== MavLandedState.ON_GROUND;
  if (landed !== null && landedAge <= MAX_AGE) return landed;
  if (state.firmware !== 'ardupilot') return landed ?? (hasFlyingMotion(state) ? true : null);
  if (!state.armed) return false;
  if (state.systemStatus === MavState.ACTIVE || hasFlyingMotion(state)) return true;
  return state.systemStatus === MavState.STANDBY ? false : null;
}

/** Whether an armed vehicle moves as none does on the ground. */
function hasFlyingMotion({ armed, position, airSpeed, groundSpeed, climbRate, throttle }: Evidence): boolean {
  if (!armed) return false;
  const isHigh = (position?.relativeAltitude ?? 0) >= FLYING_HEIGHT;
  const isFast = Math.max(airSpeed ?? 0, groundSpeed ?? 0) >= FLYING_SPEED;
  if (isHigh) return isFast || (throttle ?? 0) >= FLYING_THROTTLE;
  return isFast && Math.abs(climbRate ?? 0) >= FLYING_CLIMB;
}
