/** Numbers of instruments: an unknown value (null, NaN) becomes dashes, never a zero. */

export type Reading = number | null | undefined;

export const DASHES = '– – –';

export function isKnown(value: Reading): value is number {
  return typeof value === 'number' && Number.isFinite(value);
}

/** Return `value` with a fixed number of decimals, or dashes. A rounded zero never has a minus sign. */
export function reading(value: Reading, decimals = 0, unknown = DASHES): string {
  if (!isKnown(value)) return unknown;
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? (0).toFixed(decimals) : text;
}

/** Return an angle in degrees between 0 (included) and 360 (excluded). */
export function wrap360(degrees: number): number {
  return ((degrees % 360) + 360) % 360;
}

/** Return an angle in degrees between -180 (included) and 180 (excluded). */
export function wrap180(degrees: number): number {
  return wrap360(degrees + 180) - 180;
}

/** Return a heading as pilots write it: three digits, north is 000. */
export function headingText(degrees: Reading, unknown = DASHES): string {
  return isKnown(degrees) ? String(Math.round(wrap360(degrees)) % 360).padStart(3, '0') : unknown;
}

const POINTS = ['N', 'NE', 'E', 'SE', 'S', 'SW', 'W', 'NW'];

/** Return the nearest of the eight points of the compass. */
export function compassPoint(degrees: number): string {
  return POINTS[Math.round(wrap360(degrees) / 45) % 8] ?? 'N';
}

/** Return the label of a heading tick: the four main directions as letters, others as three digits. */
export function headingLabel(degrees: number): string {
  const heading = Math.round(wrap360(degrees)) % 360;
  return heading % 90 === 0 ? (POINTS[heading / 45] ?? '') : headingText(heading);
}

export interface Tick {
  readonly value: number;
  /** Distance from the value of the instrument, in the instrument's unit. */
  readonly offset: number;
  readonly isMajor: boolean;
}

/** Return the ticks of a tape around `value`, at multiples of `minor`; every `majorEvery`-th is a major one. */
export function tapeTicks(value: number, halfSpan: number, minor: number, majorEvery: number): Tick[] {
  const first = Math.ceil((value - halfSpan) / minor);
  const last = Math.floor((value + halfSpan) / minor);
  const ticks: Tick[] = [];
  for (let index = first; index <= last; index += 1) {
    ticks.push({ value: index * minor, offset: index * minor - value, isMajor: index % majorEvery === 0 });
  }
  return ticks;
}

/** Return minor step and half span of a tape: small speeds and altitudes get a finer scale. */
export function tapeScale(value: number, scales: readonly TapeScale[]): TapeScale {
  const fitting = scales.find((scale) => Math.abs(value) < scale.below);
  return fitting ?? scales[scales.length - 1] ?? { below: Infinity, minor: 1, majorEvery: 5, halfSpan: 10 };
}

export interface TapeScale {
  readonly below: number;
  readonly minor: number;
  readonly majorEvery: number;
  readonly halfSpan: number;
}

export const SPEED_SCALES: readonly TapeScale[] = [
  { below: 80, minor: 1, majorEvery: 5, halfSpan: 11 },
  { below: Infinity, minor: 5, majorEvery: 4, halfSpan: 45 },
];

export const ALTITUDE_SCALES: readonly TapeScale[] = [
  { below: 300, minor: 2, majorEvery: 5, halfSpan: 22 },
  { below: 3000, minor: 10, majorEvery: 5, halfSpan: 110 },
  { below: Infinity, minor: 50, majorEvery: 4, halfSpan: 450 },
];

/** Map a climb rate to -1 … 1: linear near zero, compressed beyond, full at `full`. */
export function verticalSpeedOffset(rate: number, full: number): number {
  const share = Math.min(Math.abs(rate) / full, 1);
  return Math.sign(rate) * Math.sqrt(share);
}
