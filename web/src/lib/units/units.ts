/** Values in the units that the user chose. Inside the station everything is SI, and angles are degrees. */

import { settings, type UnitSystem } from '$lib/store/settings.svelte';

export type Quantity =
  | 'distance'
  | 'altitude'
  | 'speed'
  | 'climb'
  | 'area'
  | 'angle'
  | 'heading'
  | 'voltage'
  | 'current'
  | 'percent'
  | 'temperature'
  | 'duration'
  | 'capacity'
  | 'rate'
  | 'frequency'
  | 'pressure'
  | 'number';

interface Unit {
  readonly name: string;
  /** Value in SI × factor + offset. */
  readonly factor: number;
  readonly offset?: number;
  readonly digits: number;
}

const METRE: Unit = { name: 'm', factor: 1, digits: 1 };
const FOOT: Unit = { name: 'ft', factor: 1 / 0.3048, digits: 0 };
const NO_UNIT: Unit = { name: '', factor: 1, digits: 2 };

const COMMON: Readonly<Record<Quantity, Unit>> = {
  distance: METRE,
  altitude: METRE,
  speed: { name: 'm/s', factor: 1, digits: 1 },
  climb: { name: 'm/s', factor: 1, digits: 1 },
  area: { name: 'ha', factor: 1e-4, digits: 2 },
  angle: { name: '°', factor: 1, digits: 1 },
  heading: { name: '°', factor: 1, digits: 0 },
  voltage: { name: 'V', factor: 1, digits: 1 },
  current: { name: 'A', factor: 1, digits: 1 },
  percent: { name: '%', factor: 100, digits: 0 },
  temperature: { name: '°C', factor: 1, digits: 0 },
  duration: { name: 's', factor: 1, digits: 0 },
  capacity: { name: 'mAh', factor: 1, digits: 0 },
  rate: { name: '°/s', factor: 1, digits: 0 },
  frequency: { name: 'Hz', factor: 1, digits: 1 },
  pressure: { name: 'hPa', factor: 0.01, digits: 0 },
  number: NO_UNIT,
};

const SYSTEMS: Readonly<Record<UnitSystem, Readonly<Partial<Record<Quantity, Unit>>>>> = {
  metric: {},
  imperial: {
    distance: FOOT,
    altitude: FOOT,
    speed: { name: 'mph', factor: 2.236936, digits: 1 },
    climb: { name: 'ft/min', factor: 196.850394, digits: 0 },
    area: { name: 'ac', factor: 0.000247105, digits: 2 },
    temperature: { name: '°F', factor: 1.8, offset: 32, digits: 0 },
  },
  nautical: {
    distance: METRE,
    altitude: FOOT,
    speed: { name: 'kn', factor: 1.943844, digits: 1 },
    climb: { name: 'ft/min', factor: 196.850394, digits: 0 },
  },
};

/** Shown where a value is not known. */
export const UNKNOWN = '–';

export function unitOf(quantity: Quantity, system: UnitSystem = settings.units.value): Unit {
  return SYSTEMS[system][quantity] ?? COMMON[quantity];
}

/** Returns a value of SI in the user's unit. */
export function convert(value: number, quantity: Quantity, system?: UnitSystem): number {
  const { factor, offset = 0 } = unitOf(quantity, system);
  return value * factor + offset;
}

/** Returns a value of the user's unit in SI. */
export function toSi(value: number, quantity: Quantity, system?: UnitSystem): number {
  const { factor, offset = 0 } = unitOf(quantity, system);
  return (value - offset) / factor;
}

/** Returns the number alone, such as `12.3`, or `–` for null. */
export function formatNumber(value: number | null, quantity: Quantity, digits?: number, system?: UnitSystem): string {
  if (value === null || !Number.isFinite(value)) return UNKNOWN;
  const text = convert(value, quantity, system).toFixed(digits ?? unitOf(quantity, system).digits);
  return /^-0(\.0*)?$/.test(text) ? text.slice(1) : text;
}

/** Returns a value with its unit, such as `12.3 m/s`; long distances are in km, miles or nautical miles. */
export function format(value: number | null, quantity: Quantity, digits?: number, system?: UnitSystem): string {
  if (quantity === 'distance' && value !== null && Number.isFinite(value)) return formatDistance(value, digits, system);
  if (quantity === 'duration' && value !== null) return formatDuration(value);
  const text = formatNumber(value, quantity, digits, system);
  const { name } = unitOf(quantity, system);
  if (text === UNKNOWN || name === '') return text;
  return name === '°' || name === '%' ? `${text}${name}` : `${text} ${name}`;
}

const LONG_DISTANCES: Readonly<Record<UnitSystem, { name: string; metres: number; from: number }>> = {
  metric: { name: 'km', metres: 1000, from: 1000 },
  imperial: { name: 'mi', metres: 1609.344, from: 805 },
  nautical: { name: 'nm', metres: 1852, from: 1852 },
};

function formatDistance(metres: number, digits?: number, system: UnitSystem = settings.units.value): string {
  const long = LONG_DISTANCES[system];
  if (Math.abs(metres) >= long.from) return `${(metres / long.metres).toFixed(digits ?? 2)} ${long.name}`;
  return `${formatNumber(metres, 'distance', digits ?? 0, system)} ${unitOf('distance', system).name}`;
}

/** Returns seconds as `0:42`, `12:05` or `1:02:03`. */
export function formatDuration(seconds: number): string {
  if (!Number.isFinite(seconds)) return UNKNOWN;
  const whole = Math.round(Math.abs(seconds));
  const [hours, minutes, rest] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  const two = (value: number): string => String(value).padStart(2, '0');
  const text = hours > 0 ? `${hours}:${two(minutes)}:${two(rest)}` : `${minutes}:${two(rest)}`;
  return seconds < 0 ? `-${text}` : text;
}

/** Returns latitude and longitude in degrees, such as `47.397742, 8.545594`. */
export function formatPosition(latitude: number, longitude: number): string {
  return `${latitude.toFixed(6)}, ${longitude.toFixed(6)}`;
}
