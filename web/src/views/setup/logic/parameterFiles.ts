/** Parameter files of QGroundControl, Mission Planner, MAVProxy and PX4, and their differences to a vehicle. */

import { MavParamType } from '$generated';
import type { Parameter } from '$lib/vehicle/Vehicle';

import { ownerOf, type Owner } from './owned';
import { isSame, type ParameterTable } from './parameters';

export class ParameterFileError extends Error {}

export type ParameterFormat = 'qgroundcontrol' | 'mission-planner' | 'mavproxy';

export const FORMATS: Readonly<Record<ParameterFormat, { readonly suffix: string; readonly label: string }>> = {
  qgroundcontrol: { suffix: '.params', label: 'QGroundControl (.params)' },
  'mission-planner': { suffix: '.param', label: 'Mission Planner (.param)' },
  mavproxy: { suffix: '.parm', label: 'ArduPilot, MAVProxy (.parm)' },
};

/** MAV_PARAM_TYPE by name, as QGroundControl's last column has it. */
const TYPES: Readonly<Record<string, number>> = MavParamType;
const NAME = /^[\x21-\x7e]{1,16}$/;
const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/** Returns the values by name; throws `ParameterFileError` with the line of what is wrong. */
export function readParameters(text: string): Map<string, number> {
  const found = new Map<string, number>();
  text.split(/\r?\n/).forEach((line, index) => {
    const content = line.replace(/#.*/, '').trim();
    if (content === '') return;
    const [name, value] = nameAndValue(content);
    if (!name || !NAME.test(name) || !value || !NUMBER.test(value)) {
      throw new ParameterFileError(`line ${index + 1}: ${content.slice(0, 60)} is not a name and a number`);
    }
    found.set(name, Number(value));
  });
  if (found.size === 0) throw new ParameterFileError('the file has no parameters');
  return found;
}

function nameAndValue(content: string): (string | undefined)[] {
  const words = content.split(/[\s,=]+/);
  // QGroundControl: vehicle, component, name, value, type; PX4's scripts: param set NAME VALUE.
  if (words.length === 5 && /^\d+$/.test(words[0]!) && /^\d+$/.test(words[1]!)) return words.slice(2, 4);
  if (words[0] === 'param' && /^set/.test(words[1] ?? '')) return words.slice(2, 4);
  return words.slice(0, 2);
}

export function writeParameters(
  parameters: readonly Parameter[],
  format: ParameterFormat,
  system: number,
  component: number,
): string {
  const sorted = [...parameters].sort((a, b) => (a.name < b.name ? -1 : 1));
  if (format === 'mission-planner') return sorted.map((each) => `${each.name},${each.text}\n`).join('');
  if (format === 'mavproxy') return sorted.map((each) => `${each.name.padEnd(16)} ${each.text}\n`).join('');
  const head = `# Onboard parameters for Vehicle ${system}\n#\n# Vehicle-Id Component-Id Name Value Type\n`;
  const rows = sorted.map((each) => [system, component, each.name, each.text, TYPES[each.type] ?? 9].join('\t'));
  return `${head}${rows.join('\n')}\n`;
}

export interface Difference {
  readonly name: string;
  readonly vehicle: number;
  readonly file: number;
  /** Why the value belongs to one vehicle only; null: it may be written to any. */
  readonly owner: Owner | null;
}

export interface Comparison {
  readonly different: readonly Difference[];
  /** Names that the vehicle lacks. */
  readonly onlyFile: readonly string[];
  readonly same: number;
}

/** Compares the values of a file with those of a vehicle; numbers in files are rounded to seven digits. */
export function compare(parameters: ParameterTable, file: ReadonlyMap<string, number>): Comparison {
  const different: Difference[] = [];
  const onlyFile: string[] = [];
  let same = 0;
  for (const [name, value] of file) {
    const held = parameters[name];
    if (!held) onlyFile.push(name);
    else if (agrees(held.value, value)) same += 1;
    else different.push({ name, vehicle: held.value, file: value, owner: ownerOf(name) });
  }
  const byName = (a: { name: string }, b: { name: string }): number => (a.name < b.name ? -1 : 1);
  return { different: different.sort(byName), onlyFile: onlyFile.sort(), same };
}

/** Returns the differences that are chosen before the user chooses: none that belongs to one vehicle only. */
export function chosenAtFirst({ different }: Comparison): ReadonlySet<string> {
  return new Set(different.filter(({ owner }) => owner === null).map(({ name }) => name));
}

/** Returns the chosen values in the order of writing: ids last, since the vehicle may change its id at once. */
export function valuesToWrite({ different }: Comparison, chosen: ReadonlySet<string>): Map<string, number> {
  const wanted = different.filter(({ name }) => chosen.has(name));
  const last = ({ owner }: Difference): number => Number(owner === 'IDENTITY');
  return new Map(wanted.sort((one, other) => last(one) - last(other)).map(({ name, file }) => [name, file]));
}

function agrees(held: number, written: number): boolean {
  return (
    isSame(held, written) ||
    Number(held.toPrecision(7)) === Number(written.toPrecision(7)) ||
    held.toFixed(6) === written.toFixed(6)
  );
}
