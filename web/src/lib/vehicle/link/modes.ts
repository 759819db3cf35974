/** Modes for the actions that firmwares and vehicle types name differently, from the tables of `mavstack.vehicle`. */

import uses from '../../../generated/modes.json';
import type { VehicleState, VehicleType } from '../Vehicle';
import { ardupilotModes, px4Modes } from '../vehicleType';

type Use = 'noArming' | 'selfStarting' | 'waiting' | 'hold' | 'land';
type ByType = Readonly<Record<string, string | readonly string[] | undefined>>;

/** Uses of modes by firmware, use and type. */
const USES: Readonly<Record<string, Readonly<Record<Use, ByType>> | undefined>> = uses;
/** Modes in which a type lands that no call of `mavstack.vehicle` lands: a submarine comes up. */
const LANDING_ELSE: Readonly<Partial<Record<VehicleType, string>>> = { sub: 'SURFACE' };

export const RETURN_MODES = ['RTL', 'SURFACE'];
export const MISSION_MODES = ['AUTO', 'MISSION'];

/** Modes that no user enters. */
export const NOT_SELECTABLE: ReadonlySet<string> = new Set([
  'INITIALISING',
  'INITIALIZING',
  'READY',
  'RATTITUDE',
  'SIMPLE',
  'TERMINATION',
]);

type Typed = Pick<VehicleState, 'firmware' | 'type'>;
type Moded = Typed & Pick<VehicleState, 'mode'>;

function modeFor(use: Use, { firmware, type }: Typed): string | null {
  const found = modesFor(use, { firmware, type });
  return typeof found === 'string' ? found : null;
}

function modesFor(use: Use, { firmware, type }: Typed): string | readonly string[] | undefined {
  return USES[firmware]?.[use][type === 'helicopter' ? 'copter' : type];
}

/** Returns the mode in which a vehicle stays where it is. */
export function holdMode(firmware: VehicleState['firmware'], type: VehicleType): string {
  return modeFor('hold', { firmware, type }) ?? 'LOITER';
}

/** Returns the mode in which a vehicle lands here. */
export function landMode(firmware: VehicleState['firmware'], type: VehicleType): string {
  const other = firmware === 'ardupilot' ? LANDING_ELSE[type] : undefined;
  return modeFor('land', { firmware, type }) ?? other ?? 'LAND';
}

/** Returns whether the firmware arms in the present mode; true if that is not known. */
export function allowsArming(state: Moded): boolean {
  return state.mode === null || !modesFor('noArming', state)?.includes(state.mode);
}

/** Returns whether a vehicle that is armed in its mode starts to fly or to drive without a command. */
export function startsByItself(state: Moded): boolean {
  return state.mode !== null && (modesFor('selfStarting', state)?.includes(state.mode) ?? false);
}

/** Returns the mode in which a vehicle waits on the ground once it is armed, or null. */
export function waitingMode(state: Typed): string | null {
  return modeFor('waiting', state);
}

/** Returns the numbers of the modes of a firmware by their names. */
export function modeNumbers({ firmware, type }: Typed): Readonly<Record<string, number>> {
  if (firmware === 'px4') return px4Modes();
  return firmware === 'ardupilot' ? ardupilotModes(type) : {};
}
