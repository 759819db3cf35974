/** Parameters with their metadata: search, groups, defaults, and whether a value is allowed. */

import type { Parameter } from '$lib/vehicle/Vehicle';

import { ranker } from './ranking';

/** The metadata of one parameter, as the station's API gives it; a fact that is not stated is null or empty. */
export interface ParameterMetadata {
  readonly name: string;
  readonly short_description: string;
  readonly long_description: string;
  readonly unit: string;
  readonly minimum: number | null;
  readonly maximum: number | null;
  readonly default: number | null;
  readonly increment: number | null;
  readonly decimal_places: number | null;
  /** Names by value. */
  readonly values: Readonly<Record<string, string>>;
  /** Names by the number of the bit. */
  readonly bitmask: Readonly<Record<string, string>>;
  readonly reboot_required: boolean;
  readonly read_only: boolean;
  readonly volatile: boolean;
  readonly group: string;
  readonly category: string;
}

export type MetadataTable = Readonly<Record<string, ParameterMetadata>>;
export type ParameterTable = Readonly<Record<string, Parameter>>;

export interface Row {
  readonly parameter: Parameter;
  readonly metadata: ParameterMetadata | null;
  /** Null: the default is not known. */
  readonly isDefault: boolean | null;
}

export const EMPTY_METADATA: ParameterMetadata = {
  name: '',
  short_description: '',
  long_description: '',
  unit: '',
  minimum: null,
  maximum: null,
  default: null,
  increment: null,
  decimal_places: null,
  values: {},
  bitmask: {},
  reboot_required: false,
  read_only: false,
  volatile: false,
  group: '',
  category: '',
};

/** Returns whether two values are the same float32, which is what parameters are on the wire. */
export function isSame(one: number, other: number): boolean {
  return Object.is(Math.fround(one), Math.fround(other)) || Math.fround(one) === Math.fround(other);
}

/** Returns the group of a parameter: that of its metadata, or the beginning of its name. */
export function groupOf(name: string, metadata: ParameterMetadata | null): string {
  const group = metadata?.group || name.split('_')[0]!;
  return group.replace(/_$/, '');
}

export function rowsOf(parameters: ParameterTable, metadata: MetadataTable): Row[] {
  return Object.values(parameters)
    .map((parameter) => {
      const known = metadata[parameter.name] ?? null;
      const isDefault = known?.default == null ? null : isSame(parameter.value, known.default);
      return { parameter, metadata: known, isDefault };
    })
    .sort((a, b) => (a.parameter.name < b.parameter.name ? -1 : 1));
}

export interface Filter {
  readonly text: string;
  /** Empty: all groups. */
  readonly group: string;
  readonly onlyChanged: boolean;
}

/** Returns the rows that have all words of a text in name or description, the best hits first. */
export function search(rows: readonly Row[], { text, group, onlyChanged }: Filter): Row[] {
  const kept = rows.filter((row) => {
    if (onlyChanged && row.isDefault !== false) return false;
    return !group || groupOf(row.parameter.name, row.metadata) === group;
  });
  const rank = ranker(text);
  if (rank === null) return kept;
  const ranked = kept.map((row) => ({ row, rank: rank(row) })).filter((each) => each.rank !== null);
  // Equal ones stay in the order of their names.
  return ranked.sort((one, other) => other.rank! - one.rank!).map((each) => each.row);
}

/** Returns the groups with the number of their parameters; single parameters are not worth a group. */
export function groupsOf(rows: readonly Row[]): { name: string; count: number }[] {
  const counts = new Map<string, number>();
  for (const { parameter, metadata } of rows) {
    const group = groupOf(parameter.name, metadata);
    counts.set(group, (counts.get(group) ?? 0) + 1);
  }
  return [...counts].map(([name, count]) => ({ name, count })).sort((a, b) => a.name.localeCompare(b.name));
}

export type Problem = 'readOnly' | 'notNumber' | 'notWhole' | 'tooLow' | 'tooHigh';

/** Returns why a value is not allowed; null if it is. */
export function problemOf(value: number, parameter: Parameter, metadata: ParameterMetadata | null): Problem | null {
  if (metadata?.read_only) return 'readOnly';
  if (!Number.isFinite(value)) return 'notNumber';
  if (isInteger(parameter) && !Number.isInteger(value)) return 'notWhole';
  if (metadata?.minimum != null && value < metadata.minimum && !(value in metadata.values)) return 'tooLow';
  if (metadata?.maximum != null && value > metadata.maximum && !(value in metadata.values)) return 'tooHigh';
  return null;
}

export function isInteger(parameter: Parameter): boolean {
  return /^U?INT/.test(parameter.type);
}

/** Returns the named values in the order of their numbers. */
export function namedValues(metadata: ParameterMetadata | null): { value: number; name: string }[] {
  const entries = Object.entries(metadata?.values ?? {}).map(([value, name]) => ({ value: Number(value), name }));
  return entries.sort((a, b) => a.value - b.value);
}

/** Returns whether the value must be one of the named ones: names beside a range are examples only. */
export function hasOnlyNamed(metadata: ParameterMetadata | null): boolean {
  if (!metadata || metadata.minimum !== null || metadata.maximum !== null) return false;
  const values = Object.keys(metadata.values).map(Number);
  return values.length > 0 && values.every(Number.isInteger);
}

export function namedBits(metadata: ParameterMetadata | null): { bit: number; name: string }[] {
  const entries = Object.entries(metadata?.bitmask ?? {}).map(([bit, name]) => ({ bit: Number(bit), name }));
  return entries.sort((a, b) => a.bit - b.bit);
}

/** Returns whether a bit is set; values may have more than 32 bits. */
export function hasBit(value: number, bit: number): boolean {
  return Math.floor(value / 2 ** bit) % 2 !== 0;
}

export function toggleBit(value: number, bit: number): number {
  return hasBit(value, bit) ? value - 2 ** bit : value + 2 ** bit;
}
