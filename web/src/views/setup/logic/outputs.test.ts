import { describe, expect, it } from 'vitest';

import { isReversed, motorOf, outputsOf, reversed } from './outputs';
import type { ParameterTable } from './parameters';

const table = (values: Record<string, number>): ParameterTable =>
  Object.fromEntries(
    Object.entries(values).map(([name, value]) => [name, { name, value, text: String(value), type: 'INT16' }]),
  );

describe('outputs', () => {
  it('of ArduPilot have a parameter for the direction of each', () => {
    const parameters = table({ SERVO10_FUNCTION: 0, SERVO2_FUNCTION: 34, SERVO2_REVERSED: 1 });
    const [second, tenth] = outputsOf(parameters);
    expect([second?.label, tenth?.label]).toEqual(['2', '10']);
    expect([isReversed(second!, parameters), isReversed(tenth!, parameters)]).toEqual([true, null]);
    expect(reversed(second!, 1)).toBe(0);
  });

  it('of PX4 share bits', () => {
    const parameters = table({ PWM_MAIN_FUNC1: 101, PWM_MAIN_FUNC3: 103, PWM_AUX_FUNC1: 201, PWM_MAIN_REV: 4 });
    const outputs = outputsOf(parameters);
    expect(outputs.map(({ label, number }) => [label, number])).toEqual([
      ['MAIN 1', 1],
      ['MAIN 3', 3],
      ['AUX 1', 9],
    ]);
    expect(outputs.map((each) => isReversed(each, parameters))).toEqual([false, true, null]);
    expect([reversed(outputs[1]!, 4), reversed(outputs[0]!, 4)]).toEqual([0, 5]);
  });

  it('run motors by the numbers of each firmware', () => {
    const [servo] = outputsOf(table({ SERVO1_FUNCTION: 33 }));
    expect([0, 32, 33, 40, 41, 81, 82, 85, 86, 101].map((value) => motorOf(servo!, value))).toEqual([
      null,
      null,
      1,
      8,
      null,
      null,
      9,
      12,
      null,
      null,
    ]);
    const [pwm] = outputsOf(table({ PWM_AUX_FUNC1: 101 }));
    expect([33, 100, 101, 112, 113].map((value) => motorOf(pwm!, value))).toEqual([null, null, 1, 12, null]);
  });
});
