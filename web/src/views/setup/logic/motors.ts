/** Tests of single motors on the ground. */

import { commandNumber } from '$lib/vehicle/link/commands';

import type { Firmware } from './calibration';

/** ACTUATOR_OUTPUT_FUNCTION_MOTOR1. */
const FIRST_MOTOR = 1;
const MOTORS_BY_TYPE: Readonly<Record<number, number>> = {
  2: 4,
  13: 6,
  14: 8,
  15: 3,
  29: 12,
  35: 10,
  4: 1,
  3: 2,
  1: 1,
};

/** Returns the number of motors of a MAV_TYPE; parameters of PX4 and VTOLs may know better. */
export function motorCount(mavType: number, rotors: number | undefined): number {
  if (rotors !== undefined && rotors >= 1 && rotors <= 12) return Math.round(rotors);
  return MOTORS_BY_TYPE[mavType] ?? 4;
}

export interface MotorCommand {
  readonly command: string;
  readonly params: readonly number[];
}

/** Returns the command that runs a motor, from 1, with a throttle in percent; 0 s stop it. */
export function motorCommand(firmware: Firmware, motor: number, throttle: number, seconds: number): MotorCommand {
  if (firmware === 'px4')
    return { command: 'ACTUATOR_TEST', params: [throttle / 100, seconds, 0, 0, FIRST_MOTOR + motor - 1] };
  // ArduPilot counts motors clockwise from the front right one.
  return { command: 'DO_MOTOR_TEST', params: [motor, 0, throttle, seconds, 1] };
}

/** Returns a command as the fields of COMMAND_LONG, which is not sent again if it is lost. */
export function motorMessage({ command, params }: MotorCommand): Record<string, number> {
  const fields = params.map((value, index) => [`param${index + 1}`, value]);
  return { command: commandNumber(command), ...Object.fromEntries(fields) };
}
