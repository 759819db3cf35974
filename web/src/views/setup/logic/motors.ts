/** Tests of single motors on the ground. */

import { ActuatorOutputFunction, MavType } from '$generated';
import { commandNumber } from '$lib/vehicle/link/commands';

import type { Firmware } from './calibration';

const MOTORS_BY_TYPE: Readonly<Record<number, number>> = {
  [MavType.QUADROTOR]: 4,
  [MavType.HEXAROTOR]: 6,
  [MavType.OCTOROTOR]: 8,
  [MavType.TRICOPTER]: 3,
  [MavType.DODECAROTOR]: 12,
  [MavType.DECAROTOR]: 10,
  [MavType.HELICOPTER]: 1,
  [MavType.COAXIAL]: 2,
  [MavType.FIXED_WING]: 1,
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
    return {
      command: 'ACTUATOR_TEST',
      params: [throttle / 100, seconds, 0, 0, ActuatorOutputFunction.MOTOR1 + motor - 1],
    };
  // ArduPilot counts motors clockwise from the front right one.
  return { command: 'DO_MOTOR_TEST', params: [motor, 0, throttle, seconds, 1] };
}

/** Returns a command as the fields of COMMAND_LONG, which is not sent again if it is lost. */
export function motorMessage({ command, params }: MotorCommand): Record<string, number> {
  const fields = params.map((value, index) => [`param${index + 1}`, value]);
  return { command: commandNumber(command), ...Object.fromEntries(fields) };
}
