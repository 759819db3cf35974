/** The check list before each flight: items that the vehicle answers, and items that a pilot ticks, by vehicle type. */

import type { TextKey } from '$lib/i18n';
import type { VehicleState, VehicleType } from '$lib/vehicle/Vehicle';

/** `unknown`: the vehicle does not report it. */
export type CheckState = 'ok' | 'bad' | 'unknown';

export interface AutomaticCheck {
  readonly key: TextKey;
  readonly state: CheckState;
}

/** GPS_FIX_TYPE of a position in space. */
const FIX_3D = 3;
const MIN_SATELLITES = 6;
/** Shares of a battery, of a radio signal, and of lost messages. */
const MIN_CHARGE = 0.5;
const MIN_SIGNAL = 0.3;
const MAX_LOSS = 0.1;
/** Of the variances of an estimate; 1 is the limit of the firmware. */
const MAX_ESTIMATE = 0.8;
/** Types that find their place without satellites. */
const WITHOUT_GPS: ReadonlySet<VehicleType> = new Set(['sub', 'tracker', 'blimp']);

/** Returns the checks that the vehicle answers by its values. */
export function automaticChecks(state: VehicleState): AutomaticCheck[] {
  const { gps, battery, estimator, rc } = state;
  const isKnown = state.rc !== null && rc?.rssi != null;
  return [
    // A vehicle that is not alive has no figure of losses.
    { key: 'preflight.link', state: state.alive ? judged(state.loss, (state.loss ?? 0) <= MAX_LOSS) : 'bad' },
    { key: 'preflight.ready', state: judged(state.ready, state.ready === true) },
    ...(WITHOUT_GPS.has(state.type)
      ? []
      : [
          {
            key: 'preflight.gps',
            state: judged(gps, (gps?.fix ?? 0) >= FIX_3D && (gps?.satellites ?? MIN_SATELLITES) >= MIN_SATELLITES),
          } as const,
          { key: 'preflight.home', state: judged(state.home, state.home !== null) } as const,
        ]),
    { key: 'preflight.battery', state: judged(battery?.remaining, (battery?.remaining ?? 0) >= MIN_CHARGE) },
    { key: 'preflight.estimate', state: judged(estimator?.ratio, (estimator?.ratio ?? 1) <= MAX_ESTIMATE) },
    { key: 'preflight.remote', state: isKnown ? (rc.rssi >= MIN_SIGNAL ? 'ok' : 'bad') : 'unknown' },
    { key: 'preflight.fence', state: judged(state.fenceBreached, state.fenceBreached === false) },
    { key: 'preflight.id', state: state.conflict === null ? 'ok' : 'bad' },
  ];
}

function judged(value: unknown, isGood: boolean): CheckState {
  if (value === null || value === undefined) return 'unknown';
  return isGood ? 'ok' : 'bad';
}

const ALWAYS: readonly TextKey[] = ['preflight.frame', 'preflight.payload', 'preflight.weather', 'preflight.area'];
const ROTORS: readonly TextKey[] = ['preflight.propellers', 'preflight.arms'];
const WINGS: readonly TextKey[] = [
  'preflight.propellers',
  'preflight.surfaces',
  'preflight.airspeed',
  'preflight.runway',
];
const OTHERS: Readonly<Partial<Record<VehicleType, readonly TextKey[]>>> = {
  copter: ROTORS,
  helicopter: ['preflight.blades', 'preflight.swash'],
  plane: WINGS,
  vtol: [...WINGS, 'preflight.tilt'],
  rover: ['preflight.wheels'],
  boat: ['preflight.hull', 'preflight.screws'],
  sub: ['preflight.seals', 'preflight.screws', 'preflight.tether'],
};

/** Returns the items that the pilot ticks. */
export function manualChecks(type: VehicleType): readonly TextKey[] {
  return [...(OTHERS[type] ?? []), ...ALWAYS];
}
