import { expect, it } from 'vitest';
import { Ring } from './Ring';
import { spectrumColumns, spectrumOf, transform } from './fft';

function sine(frequency: number, amplitude: number, rate: number, jitter = 0): Ring {
  const ring = new Ring(1024);
  for (let index = 0; index < 600; index++) {
    const time = index / rate + (index % 3) * jitter;
    ring.push(time * 1000, 10 + amplitude * Math.sin(2 * Math.PI * frequency * time));
  }
  return ring;
}

function peak(ring: Ring): [number, number] {
  const { frequencies, amplitudes } = spectrumOf(ring)!;
  const place = amplitudes.indexOf(Math.max(...amplitudes));
  return [frequencies[place]!, amplitudes[place]!];
}

it('finds the frequency and the amplitude of a sine', () => {
  const [frequency, amplitude] = peak(sine(12.5, 2, 100));
  // Within half a step of 100/512 Hz.
  expect(Math.abs(frequency - 12.5)).toBeLessThan(0.1);
  expect(amplitude).toBeGreaterThan(1.7);
  expect(amplitude).toBeLessThan(2.1);
});

it('is that of the newest values', () => {
  const ring = sine(5, 1, 100);
  for (let index = 0; index < 64; index++)
    ring.push((6 + index / 100) * 1000, Math.sin(2 * Math.PI * 25 * (index / 100)));
  const { frequencies, amplitudes, rate } = spectrumOf(ring, 1, 64)!;
  expect(frequencies[amplitudes.indexOf(Math.max(...amplitudes))]).toBeCloseTo(25, 0);
  expect(frequencies).toHaveLength(32);
  expect(rate).toBeCloseTo(100, 6);
});

it('bears values that come unevenly', () => {
  expect(peak(sine(8, 1, 50, 0.004))[0]).toBeCloseTo(8, 0);
});

it('has no spectrum of a few values', () => {
  const ring = new Ring(64);
  for (let index = 0; index < 15; index++) ring.push(index, index);
  expect(spectrumOf(ring)).toBeNull();
});

it('has no spectrum of values of one moment', () => {
  const ring = new Ring(64);
  for (let index = 0; index < 32; index++) ring.push(5, index);
  expect(spectrumOf(ring)).toBeNull();
});

it('equals the definition of the transform', () => {
  const values = [1, 2, 0, -1, 3, 0.5, -2, 4];
  const real = Float64Array.from(values);
  const imaginary = new Float64Array(8);
  transform(real, imaginary);
  for (let bin = 0; bin < 8; bin++) {
    let [x, y] = [0, 0];
    values.forEach((value, index) => {
      x += value * Math.cos((2 * Math.PI * bin * index) / 8);
      y -= value * Math.sin((2 * Math.PI * bin * index) / 8);
    });
    expect(real[bin]).toBeCloseTo(x, 9);
    expect(imaginary[bin]).toBeCloseTo(y, 9);
  }
});

it('spectra of different rates share a column of frequencies', () => {
  const spectrum = (step: number, ...amplitudes: number[]) => ({
    frequencies: amplitudes.map((_, bin) => bin * step),
    amplitudes,
    rate: 1,
  });
  expect(spectrumColumns([spectrum(1, 5, 6), null, spectrum(0.5, 7, 8, 9)])).toEqual([
    [0, 0.5, 1],
    [5, null, 6],
    [null, null, null],
    [7, 8, 9],
  ]);
  expect(spectrumColumns([null])).toEqual([[], []]);
});
