/** Values of fields for people: names of enums, flags, arrays, texts. */
import type { FieldInfo } from '$generated';
import { enumName, enumValues, officialName } from '$lib/decoder/Decoder';
import { readableNumber } from '$lib/plot/style';
import { isArray, numberOf } from '$lib/series/fieldRef';

export interface ShownValue {
  readonly text: string;
  /** Name of an enum's value or of its flags; empty: none. */
  readonly note: string;
}

const MAX_ITEMS = 64;

/** Returns the text of a value, and its name if the field has an enum. */
export function shownValue(value: unknown, field: FieldInfo | null): ShownValue {
  if (isArray(value)) return { text: arrayText(value), note: '' };
  if (typeof value === 'string') return { text: JSON.stringify(value), note: '' };
  if (typeof value === 'bigint') return { text: value.toString(), note: enumNote(value, field) };
  if (typeof value === 'number') return { text: numberText(value), note: enumNote(value, field) };
  return { text: String(value ?? '–'), note: '' };
}

function numberText(value: number): string {
  return Number.isNaN(value) ? 'NaN' : Number.isFinite(value) ? readableNumber(value) : String(value);
}

function arrayText(value: ArrayLike<unknown>): string {
  const items = Array.from({ length: Math.min(value.length, MAX_ITEMS) }, (_, index) => value[index]);
  const texts = items.map((item) => (typeof item === 'number' ? numberText(item) : String(item)));
  return `[${texts.join(', ')}${value.length > MAX_ITEMS ? ', …' : ''}]`;
}

function enumNote(value: number | bigint, field: FieldInfo | null): string {
  if (field?.enum === undefined) return '';
  return enumName(field.enum, value) ?? flagNames(field.enum, value);
}

/** Returns the names of the flags of a bitmask; an enum whose values are not bits has none. */
function flagNames(name: string, value: number | bigint): string {
  const bits = BigInt(value);
  const entries = Object.entries(enumValues(name) ?? {}).filter(([, flag]) => isBit(BigInt(flag)));
  const names = entries.filter(([, flag]) => (bits & BigInt(flag)) !== 0n).map(([flag]) => officialName(flag));
  const covered = entries.reduce((sum, [, flag]) => sum | BigInt(flag), 0n);
  return (bits & ~covered) === 0n ? names.join(' · ') : '';
}

function isBit(value: bigint): boolean {
  return value > 0n && (value & (value - 1n)) === 0n;
}

/** Returns the names and indexes of a field that can be plotted: one, or one for each element of an array. */
export function plottable(value: unknown): (number | undefined)[] {
  if (!isArray(value)) return numberOf(value) === null && typeof value !== 'number' ? [] : [undefined];
  return Array.from({ length: Math.min(value.length, MAX_ITEMS) }, (_, index) => index);
}
