/** Outputs of a board: function, direction and the pulse of the moment, by the parameters of each firmware. */

import type { ParameterTable } from './parameters';

export interface Output {
  /** As printed on the board: `1`, `MAIN 1`, `AUX 1`. */
  readonly label: string;
  /** Number of the output in SERVO_OUTPUT_RAW, from 1; 0: not in it. */
  readonly number: number;
  readonly functionName: string;
  /** The parameter of the direction; empty: the firmware has none for this output. */
  readonly directionName: string;
  /** The bit of the direction in it; null: the parameter is 0 or 1. */
  readonly bit: number | null;
}

const SERVO = /^SERVO(\d+)_FUNCTION$/;
const PWM = /^PWM_(MAIN|AUX)_FUNC(\d+)$/;
const MAIN_OUTPUTS = 8;

/** Returns the outputs of a vehicle in their order. */
export function outputsOf(parameters: ParameterTable): Output[] {
  const found = Object.keys(parameters).flatMap((name) => servo(name, parameters) ?? pwm(name, parameters) ?? []);
  return found.sort((one, other) => one.number - other.number);
}

function servo(name: string, parameters: ParameterTable): Output | null {
  const match = SERVO.exec(name);
  if (!match) return null;
  const directionName = `SERVO${match[1]}_REVERSED`;
  return {
    label: match[1]!,
    number: Number(match[1]),
    functionName: name,
    directionName: directionName in parameters ? directionName : '',
    bit: null,
  };
}

function pwm(name: string, parameters: ParameterTable): Output | null {
  const match = PWM.exec(name);
  if (!match) return null;
  const [, bank, text] = match;
  const number = Number(text);
  const directionName = `PWM_${bank}_REV`;
  return {
    label: `${bank} ${number}`,
    number: bank === 'MAIN' ? number : MAIN_OUTPUTS + number,
    functionName: name,
    directionName: directionName in parameters ? directionName : '',
    bit: number - 1,
  };
}

/** Returns whether an output is reversed; null: it has no direction. */
export function isReversed({ directionName, bit }: Output, parameters: ParameterTable): boolean | null {
  const value = parameters[directionName]?.value;
  if (value === undefined) return null;
  return bit === null ? value !== 0 : ((value >> bit) & 1) === 1;
}

/** Returns the value of the direction's parameter with the output turned the other way. */
export function reversed({ bit }: Output, held: number): number {
  return bit === null ? (held === 0 ? 1 : 0) : held ^ (1 << bit);
}

/** Values of functions, each with the number of the motor that the first one runs. */
const MOTORS = {
  SERVO: [
    { first: 33, last: 40, motor: 1 },
    { first: 82, last: 85, motor: 9 },
  ],
  PWM_: [{ first: 101, last: 112, motor: 1 }],
} as const;

/** Returns the number of the motor that an output runs; null: its function is another one. */
export function motorOf({ functionName }: Output, value: number): number | null {
  const ranges = functionName.startsWith('PWM_') ? MOTORS.PWM_ : MOTORS.SERVO;
  const range = ranges.find(({ first, last }) => first <= value && value <= last);
  return range === undefined ? null : value - range.first + range.motor;
}
