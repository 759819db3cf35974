/** Places and altitudes of commands. */

import { MavFrame } from '$generated';

import type { Target } from '../Vehicle';
import type { CommandPlace } from './commands';
import type { FlightFacts } from './flight';

/** Returns a place at an altitude above home, at the present one if it is left out. */
export function placeOf({ state, failure }: FlightFacts, target: Target, altitude?: number): CommandPlace {
  const height = altitude ?? state.position?.relativeAltitude ?? null;
  if (height === null) throw failure('its altitude is not known, enter one');
  return { ...target, frame: MavFrame.GLOBAL_RELATIVE_ALT_INT, altitude: height };
}

/** Returns the altitude of home above mean sea level. */
export function homeAltitude({ state, failure }: FlightFacts): number {
  const altitude = state.home?.altitude ?? null;
  if (altitude === null) throw failure('its home position is not known yet');
  return altitude;
}

/** Returns an altitude above this place as one above mean sea level, which PX4 takes. */
export function aboveSea({ state, failure }: FlightFacts, altitude: number): number {
  const sea = state.position?.altitude ?? null;
  if (sea === null) throw failure('no position yet');
  return sea + altitude;
}
