/** Behaviour of a vehicle of the demo in each of ArduPilot's modes. */

import type { VehicleType } from '$lib/vehicle/Vehicle';

export type Behaviour = 'manual' | 'stay' | 'guided' | 'mission' | 'return' | 'land' | 'circle' | 'surface';

const BEHAVIOURS: Readonly<Record<string, Behaviour>> = {
  GUIDED: 'guided',
  AUTO: 'mission',
  RTL: 'return',
  SMART_RTL: 'return',
  QRTL: 'return',
  LAND: 'land',
  QLAND: 'land',
  CIRCLE: 'circle',
  SURFACE: 'surface',
  LOITER: 'stay',
  QLOITER: 'stay',
  QHOVER: 'stay',
  POSHOLD: 'stay',
  BRAKE: 'stay',
  HOLD: 'stay',
  TAKEOFF: 'guided',
};

/** Returns the behaviour of a mode; in the others the pilot flies. */
export function behaviourOf(mode: string | null): Behaviour {
  return BEHAVIOURS[mode ?? ''] ?? 'manual';
}

/** Returns the mode in which a vehicle stands before its first command. */
export function firstMode(type: VehicleType): string {
  if (type === 'plane') return 'FLY_BY_WIRE_A';
  if (type === 'vtol') return 'QLOITER';
  if (type === 'rover' || type === 'boat') return 'HOLD';
  return type === 'sub' ? 'ALT_HOLD' : 'STABILIZE';
}
