/** The switch on the transmitter that selects flight modes: its channel, and its position by the pulse. */

import type { Firmware } from './calibration';
import type { ParameterTable } from './parameters';

export const POSITIONS = [1, 2, 3, 4, 5, 6] as const;

/** Upper ends of the pulses of ArduPilot's positions; others than these receivers do not send. */
const ENDS = [1230, 1360, 1490, 1620, 1749, 2199];
const SHORTEST = 900;

/** Returns the channel of the switch, from 1; 0: there is none. */
export function channelOf(firmware: Firmware, parameters: ParameterTable): number {
  const names = firmware === 'px4' ? ['RC_MAP_FLTMODE'] : ['FLTMODE_CH', 'MODE_CH'];
  const found = names.find((name) => parameters[name]);
  return found ? parameters[found]!.value : 0;
}

/** Returns the name of the parameter of a position; null if the vehicle has none. */
export function slotOf(firmware: Firmware, position: number, parameters: ParameterTable): string | null {
  const names = firmware === 'px4' ? [`COM_FLTMODE${position}`] : [`FLTMODE${position}`, `MODE${position}`];
  return names.find((name) => parameters[name]) ?? null;
}

/** Returns the position of the switch, from 1; null: it is not known. */
export function positionOf(firmware: Firmware, pulse: number | null, parameters: ParameterTable): number | null {
  if (pulse === null || pulse <= SHORTEST) return null;
  if (firmware === 'px4') return px4Position(pulse, channelOf(firmware, parameters), parameters);
  const index = ENDS.findIndex((end) => pulse <= end);
  return index < 0 ? null : index + 1;
}

/** PX4 scales the channel to -1 … 1 by its calibration, and divides a little more than that by the positions. */
function px4Position(pulse: number, channel: number, parameters: ParameterTable): number {
  const fact = (name: string, initial: number): number => parameters[`RC${channel}_${name}`]?.value ?? initial;
  const [trim, deadZone] = [fact('TRIM', 1500), fact('DZ', 0)];
  let value = 0;
  if (pulse > trim + deadZone) value = (pulse - trim - deadZone) / (fact('MAX', 2000) - trim - deadZone);
  else if (pulse < trim - deadZone) value = (pulse - trim + deadZone) / (trim - fact('MIN', 1000) - deadZone);
  const turned = Math.max(-1, Math.min(1, value)) * (fact('REV', 1) < 0 ? -1 : 1);
  const half = 1 / POSITIONS.length;
  const share = ((turned + 1.05) * POSITIONS.length + half) / 2.1 + half;
  return Math.min(POSITIONS.length, Math.floor(share) + 1);
}
