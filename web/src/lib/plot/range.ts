/** Ranges of the vertical axis of plots. */

/** Most fields are 32-bit floats; four steps of their precision are noise rather than a signal. */
const MIN_RELATIVE_SPAN = 4 * 2 ** -23;
/** Values around zero have no size to compare with; no unit of MAVLink makes a signal of less visible. */
const MIN_SPAN = 1e-4;
const MARGIN = 0.08;

/** Spans by unit below which a change means nothing to a pilot: a parked vehicle's sensors would fill the plot. */
const MIN_UNIT_SPANS: Readonly<Record<string, number>> = {
  m: 1,
  ft: 3,
  'm/s': 0.5,
  kn: 1,
  mph: 1,
  'ft/min': 100,
  deg: 1,
  '°': 1,
  V: 0.2,
  A: 0.5,
  '%': 5,
};

/**
 * Returns the ends of an axis for values between two limits; the noise of a constant value does not fill it.
 *
 * @param unit - Of the values; empty: not known.
 */
export function paddedRange(low: number | null, high: number | null, unit = ''): [number, number] {
  if (low === null || high === null || !Number.isFinite(low + high)) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  const smallest = Math.max(size * MIN_RELATIVE_SPAN, MIN_SPAN);
  if (high - low < smallest) {
    // A constant value is drawn in the middle, on an axis that tells its size.
    const [middle, half] = [(low + high) / 2, size > smallest ? size * 0.05 : 1];
    return [middle - half, middle + half];
  }
  const span = MIN_UNIT_SPANS[unit] ?? 0;
  if (high - low < span) return [(low + high - span) / 2, (low + high + span) / 2];
  const margin = (high - low) * MARGIN;
  return [low - margin, high + margin];
}
