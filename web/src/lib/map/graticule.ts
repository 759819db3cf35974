/** Lines of latitude and longitude, which the page draws itself: a map that needs no internet. */
import type { Bounds } from './geometry';

const MINUTE = 1 / 60;
const SECOND = MINUTE / 60;
/** Steps that people read easily: degrees, minutes, seconds. */
const STEPS: readonly number[] = [
  45,
  30,
  15,
  10,
  5,
  2,
  1,
  30 * MINUTE,
  15 * MINUTE,
  10 * MINUTE,
  5 * MINUTE,
  2 * MINUTE,
  MINUTE,
  30 * SECOND,
  15 * SECOND,
  10 * SECOND,
  5 * SECOND,
  2 * SECOND,
  SECOND,
  SECOND / 2,
  SECOND / 5,
  SECOND / 10,
  SECOND / 20,
  SECOND / 50,
  SECOND / 100,
];

export interface Graticule {
  /** Degrees between lines. */
  readonly step: number;
  readonly latitudes: readonly number[];
  readonly longitudes: readonly number[];
}

/** Return the largest step of which at least `lines` fit into `degrees`. */
export function graticuleStep(degrees: number, lines = 4): number {
  return STEPS.find((step) => degrees / step >= lines) ?? STEPS[STEPS.length - 1]!;
}

function multiples(low: number, high: number, step: number): number[] {
  const values = [];
  for (let index = Math.ceil(low / step - 1e-9); index * step <= high + 1e-12 && values.length < 200; index += 1) {
    values.push(index * step);
  }
  return values;
}

/** Return the lines that cross the bounds. */
export function graticule(bounds: Bounds): Graticule {
  const step = graticuleStep(Math.min(bounds.east - bounds.west, (bounds.north - bounds.south) * 1.8));
  return {
    step,
    latitudes: multiples(bounds.south, bounds.north, step).filter((latitude) => Math.abs(latitude) < 90),
    longitudes: multiples(bounds.west, bounds.east, step),
  };
}

/** Return an angle as degrees, minutes and seconds, as exact as the step needs: `47°23′30″N`. */
export function angleText(degrees: number, step: number, axis: 'latitude' | 'longitude'): string {
  const wrapped = axis === 'longitude' ? ((((degrees + 180) % 360) + 360) % 360) - 180 : degrees;
  const letters = axis === 'latitude' ? 'NS' : 'EW';
  const decimals = step < SECOND * 0.99 ? (step < SECOND / 10 - 1e-12 ? 2 : 1) : 0;
  const unit = 10 ** decimals;
  let rest = Math.round(Math.abs(wrapped) * 3600 * unit);
  const letter = rest === 0 ? '' : wrapped > 0 ? letters[0] : letters[1];
  const seconds = (rest % (60 * unit)) / unit;
  rest = Math.floor(rest / (60 * unit));
  const [minutes, whole] = [rest % 60, Math.floor(rest / 60)];
  if (step >= 0.999) return `${whole}°${letter}`;
  const text = `${whole}°${String(minutes).padStart(2, '0')}′`;
  if (step >= MINUTE * 0.999) return `${text}${letter}`;
  return `${text}${seconds.toFixed(decimals).padStart(decimals > 0 ? 3 + decimals : 2, '0')}″${letter}`;
}

const SCALE_LENGTHS = [1, 2, 5];

/** Return the longest round length in metres that is not wider than `maxPixels`. */
export function scaleLength(pixelsPerMetre: number, maxPixels: number): number {
  const limit = maxPixels / pixelsPerMetre;
  const power = 10 ** Math.floor(Math.log10(limit));
  const factor = SCALE_LENGTHS.filter((length) => length * power <= limit).pop() ?? 1;
  return factor * power;
}
