/** Actions of the equipment as commands, for a vehicle that the page itself talks to. */

import { GripperActions, MavVtolState, WinchActions } from '$generated';
import type { ActionFields, ActionName } from '$lib/api/requests';

export interface EquipmentCommand {
  readonly command: string;
  readonly params: readonly (number | null)[];
}

type Commands = { readonly [Name in ActionName]?: (fields: ActionFields<Name>) => EquipmentCommand };

const COMMANDS: Commands = {
  servo: ({ servo, pulse }) => ({ command: 'DO_SET_SERVO', params: [servo, pulse] }),
  relay: ({ relay, on }) => ({ command: 'DO_SET_RELAY', params: [relay, on ? 1 : 0] }),
  actuator: ({ actuator, value }) => ({ command: 'DO_SET_ACTUATOR', params: actuatorParams(actuator, value) }),
  gripper: ({ open, gripper = 1 }) => ({
    command: 'DO_GRIPPER',
    params: [gripper, open ? GripperActions.RELEASE : GripperActions.GRAB],
  }),
  winch: ({ length, rate = 0, winch = 1 }) => ({
    command: 'DO_WINCH',
    params: [winch, WinchActions.RELATIVE_LENGTH_CONTROL, length, rate],
  }),
  'winch/run': ({ rate, winch = 1 }) => ({
    command: 'DO_WINCH',
    params: [winch, WinchActions.RATE_CONTROL, 0, rate],
  }),
  'winch/relax': ({ winch = 1 }) => ({ command: 'DO_WINCH', params: [winch, WinchActions.RELAXED] }),
  transition: ({ to }) => ({
    command: 'DO_VTOL_TRANSITION',
    params: [to === 'fixed-wing' ? MavVtolState.FW : MavVtolState.MC],
  }),
  'commit-parameters': () => ({ command: 'PREFLIGHT_STORAGE', params: [1] }),
  terminate: () => ({ command: 'DO_FLIGHTTERMINATION', params: [1] }),
};
/** Actuators of one command; the index that chooses further ones is its seventh parameter. */
const GROUP = 6;

/** Returns the parameters that leave all other actuators as they are. */
function actuatorParams(actuator: number, value: number): (number | null)[] {
  const place = (actuator - 1) % GROUP;
  const values = Array.from({ length: GROUP }, (_, index) => (index === place ? value : null));
  return [...values, Math.floor((actuator - 1) / GROUP)];
}

/** Returns the command of an action, or null if only the station carries it out. */
export function equipmentCommand<Name extends ActionName>(
  action: Name,
  fields: ActionFields<Name>,
): EquipmentCommand | null {
  const make: ((fields: ActionFields<Name>) => EquipmentCommand) | undefined = COMMANDS[action];
  return make?.(fields) ?? null;
}
