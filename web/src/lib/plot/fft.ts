/**
 * Spectrum of a series: resampled evenly, without its mean, with a Hann window, by a radix-2 FFT.
 *
 * Amplitudes are those of the sines in the signal: a sine of amplitude 2 shows as a peak of 2.
 */
import type { Ring } from './Ring';

export interface Spectrum {
  /** In hertz. */
  readonly frequencies: number[];
  /** In the unit of the series. */
  readonly amplitudes: number[];
  /** Rate of the values in hertz. */
  readonly rate: number;
}

/**
 * Returns one column of frequencies and one of amplitudes for each spectrum.
 *
 * Fields of different rates have different frequencies: a spectrum has null where only another one has a value.
 */
export function spectrumColumns(spectra: readonly (Spectrum | null)[]): [number[], ...(number | null)[][]] {
  const known = spectra.map(
    (spectrum) => new Map(spectrum?.frequencies.map((each, bin) => [each, spectrum.amplitudes[bin]!])),
  );
  const frequencies = [...new Set(known.flatMap((each) => [...each.keys()]))].sort((a, b) => a - b);
  return [frequencies, ...known.map((each) => frequencies.map((frequency) => each.get(frequency) ?? null))];
}

/** Fewer values than these have no spectrum. */
export const MIN_SPECTRUM = 16;

/** Returns the spectrum of the newest values times a factor, null while there are fewer than `MIN_SPECTRUM`. */
export function spectrumOf(ring: Ring, factor = 1, size = 512): Spectrum | null {
  const count = Math.min(ring.length, size);
  if (count < MIN_SPECTRUM) return null;
  const first = ring.length - count;
  const begin = ring.timeAt(first);
  const duration = (ring.timeAt(ring.length - 1) - begin) / 1000;
  if (!(duration > 0)) return null;
  const length = 2 ** Math.ceil(Math.log2(count));
  const rate = (count - 1) / duration;
  const samples = resample(ring, first, begin, duration, length);
  const real = windowed(samples);
  const imaginary = new Float64Array(length);
  transform(real, imaginary);
  const half = length / 2;
  // 2 for the negative frequencies, 2 for the mean of the Hann window.
  const amplitudes = Array.from(
    { length: half },
    (_, bin) => (4 * Math.abs(factor) * Math.hypot(real[bin]!, imaginary[bin]!)) / length,
  );
  const step = (length - 1) / duration / length;
  return { frequencies: amplitudes.map((_, bin) => bin * step), amplitudes, rate };
}

function resample(ring: Ring, first: number, begin: number, duration: number, length: number): Float64Array {
  const samples = new Float64Array(length);
  let index = first;
  for (let place = 0; place < length; place++) {
    const time = begin + (duration * 1000 * place) / (length - 1);
    while (index < ring.length - 2 && ring.timeAt(index + 1) < time) index++;
    const [left, right] = [ring.timeAt(index), ring.timeAt(index + 1)];
    const share = right > left ? Math.min(1, Math.max(0, (time - left) / (right - left))) : 1;
    const value = ring.valueAt(index) * (1 - share) + ring.valueAt(index + 1) * share;
    samples[place] = Number.isFinite(value) ? value : 0;
  }
  return samples;
}

function windowed(samples: Float64Array): Float64Array {
  const mean = samples.reduce((sum, value) => sum + value, 0) / samples.length;
  const turn = (2 * Math.PI) / (samples.length - 1);
  return samples.map((value, index) => (value - mean) * 0.5 * (1 - Math.cos(turn * index)));
}

/** Transforms in place; the length is a power of two. */
export function transform(real: Float64Array, imaginary: Float64Array): void {
  const length = real.length;
  reorder(real, imaginary);
  for (let size = 2; size <= length; size *= 2) {
    const angle = (-2 * Math.PI) / size;
    for (let start = 0; start < length; start += size) {
      for (let offset = 0; offset < size / 2; offset++) {
        butterfly(real, imaginary, start + offset, start + offset + size / 2, angle * offset);
      }
    }
  }
}

function butterfly(real: Float64Array, imaginary: Float64Array, even: number, odd: number, angle: number): void {
  const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
  const x = real[odd]! * cosine - imaginary[odd]! * sine;
  const y = real[odd]! * sine + imaginary[odd]! * cosine;
  real[odd] = real[even]! - x;
  imaginary[odd] = imaginary[even]! - y;
  real[even] = real[even]! + x;
  imaginary[even] = imaginary[even]! + y;
}

function reorder(real: Float64Array, imaginary: Float64Array): void {
  const length = real.length;
  for (let index = 1, reversed = 0; index < length; index++) {
    let bit = length >> 1;
    for (; reversed & bit; bit >>= 1) reversed ^= bit;
    reversed ^= bit;
    if (index < reversed) {
      for (const values of [real, imaginary]) [values[index], values[reversed]] = [values[reversed]!, values[index]!];
    }
  }
}
