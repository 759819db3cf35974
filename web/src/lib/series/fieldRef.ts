/**
 * References to values: which field of which message of which source.
 *
 * A source is `1/1` (a component of a MAVLink system), `1` (any component of that system), `*` (any system),
 * the name of a source of rows, such as `cansat`, or `script:NAME`. As text: `1/1:ATTITUDE.roll`,
 * `1:BATTERY_STATUS.voltages[0]`, `cansat:ROW.altitude`.
 */
export interface FieldRef {
  readonly source: string;
  readonly message: string;
  readonly field: string;
  /** Index in an array field. */
  readonly index?: number;
}

/** A message of any kind of source, as the series see it. */
export interface Sample {
  /** `system/component`, or the name of the source. */
  readonly source: string;
  readonly message: string;
  /** In ms since 1970. */
  readonly time: number;
  readonly fields: Readonly<Record<string, unknown>>;
}

const TEXT = /^([^:]+(?::[^:.]+)?):([A-Za-z0-9_]+)\.([^[\]]+)(?:\[(\d+)\])?$/;

/** Returns the reference of a text, null if it is none. */
export function parseFieldRef(text: string): FieldRef | null {
  const match = TEXT.exec(text.trim());
  if (match === null) return null;
  const [, source, message, field, index] = match;
  const ref = { source: source!, message: message!, field: field! };
  return index === undefined ? ref : { ...ref, index: Number(index) };
}

export function formatFieldRef(ref: FieldRef): string {
  return `${ref.source}:${ref.message}.${ref.field}${ref.index === undefined ? '' : `[${ref.index}]`}`;
}

/** Returns a short name for legends: without the message if the name of the field says enough. */
export function fieldLabel(ref: FieldRef): string {
  const index = ref.index === undefined ? '' : `[${ref.index}]`;
  return `${ref.source} ${ref.field}${index}`;
}

/** Returns whether a source is the one of a reference; `1` is any component of system 1. */
export function matchesSource(wanted: string, source: string): boolean {
  if (wanted === source || wanted === '*') return true;
  return source.startsWith(`${wanted}/`);
}

/** Returns the number of a field, null if it is missing or not a number. */
export function numberOf(value: unknown, index?: number): number | null {
  if (index !== undefined) return isArray(value) ? numberOf(value[index]) : null;
  if (typeof value === 'number') return Number.isFinite(value) ? value : null;
  if (typeof value === 'bigint') return Number(value);
  if (typeof value === 'boolean') return value ? 1 : 0;
  return null;
}

export function isArray(value: unknown): value is ArrayLike<unknown> {
  return Array.isArray(value) || (ArrayBuffer.isView(value) && 'length' in value);
}
