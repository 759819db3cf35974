import { readFileSync } from 'node:fs';

import { describe, expect, it } from 'vitest';

import { DARK as DARK_MAP, LIGHT as LIGHT_MAP, vehicleColour } from '$lib/map/palette';

import { DARK, LIGHT, seriesColour } from './colours';

type Colour = readonly [number, number, number];

/** Linear red, green and blue as seen without one kind of cones (Machado, Oliveira and Fernandes 2009, severity 1). */
const SIGHTS: Readonly<Record<string, readonly Colour[]>> = {
  all: [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ],
  protanopia: [
    [0.152286, 1.052583, -0.204868],
    [0.114503, 0.786281, 0.099216],
    [-0.003882, -0.048116, 1.051998],
  ],
  deuteranopia: [
    [0.367322, 0.860646, -0.227968],
    [0.280085, 0.672501, 0.047413],
    [-0.01182, 0.04294, 0.968881],
  ],
  tritanopia: [
    [1.255528, -0.076749, -0.178779],
    [-0.078411, 0.930809, 0.147602],
    [0.004733, 0.691367, 0.3039],
  ],
};
/** Linear red, green and blue to CIE XYZ, as parts of white (D65). */
const XYZ: readonly Colour[] = [
  [0.4124 / 0.9505, 0.3576 / 0.9505, 0.1805 / 0.9505],
  [0.2126, 0.7152, 0.0722],
  [0.0193 / 1.089, 0.1192 / 1.089, 0.9505 / 1.089],
];
/** Differences in CIELAB: 2 is just noticed side by side, 12 is clear in thin lines. */
const DISTINCT = 12;
/** Contrast that the guidelines for accessibility ask of graphics. */
const LEGIBLE = 3;

const css = readFileSync(new URL('../../theme.css', import.meta.url), 'utf8');

/** Returns a value of the theme, such as that of `--ok`. */
function token(name: string, theme: 'dark' | 'light'): string {
  const begin = theme === 'light' ? css.indexOf("[data-theme='light']") : 0;
  return new RegExp(`--${name}: (#[0-9a-f]{6})`).exec(css.slice(begin))![1]!;
}

function times(matrix: readonly Colour[], colour: Colour): Colour {
  return matrix.map((row) => row[0] * colour[0] + row[1] * colour[1] + row[2] * colour[2]) as unknown as Colour;
}

function linear(hex: string): Colour {
  return [1, 3, 5].map((at) => {
    const part = parseInt(hex.slice(at, at + 2), 16) / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  }) as unknown as Colour;
}

/** Returns lightness and the two opponent colours (CIELAB). */
function lab(hex: string, sight: readonly Colour[]): Colour {
  const seen = times(sight, linear(hex)).map((part) => Math.min(1, Math.max(0, part))) as unknown as Colour;
  const [x, y, z] = times(XYZ, seen).map((part) =>
    part > 0.008856 ? Math.cbrt(part) : 7.787 * part + 16 / 116,
  ) as unknown as Colour;
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

/** Returns the pair of colours that differ least, and by how much. */
function closest(colours: readonly string[], sight: readonly Colour[]): [number, string, string] {
  const places = colours.map((each) => lab(each, sight));
  const pairs = places.flatMap((one, index) =>
    places
      .slice(index + 1)
      .map((other, next): [number, string, string] => [
        Math.hypot(...one.map((part, at) => part - other[at]!)),
        colours[index]!,
        colours[index + 1 + next]!,
      ]),
  );
  return pairs.sort((a, b) => a[0] - b[0])[0]!;
}

function contrast(one: string, other: string): number {
  const [high, low] = [one, other].map((each) => times(XYZ, linear(each))[1]).sort((a, b) => b - a);
  return (high! + 0.05) / (low! + 0.05);
}

const shapes = ({ mission, fenceIn, fenceOut, rally }: typeof DARK_MAP): string[] => [
  mission,
  fenceIn,
  fenceOut,
  rally,
];
const states = (theme: 'dark' | 'light'): string[] => ['ok', 'warn', 'danger'].map((name) => token(name, theme));

describe.each([
  ['dark series and vehicles', DARK, token('surface', 'dark')],
  ['light series and vehicles', LIGHT, token('surface', 'light')],
  ['dark states', states('dark'), token('surface', 'dark')],
  ['light states', states('light'), token('surface', 'light')],
  ['plans on the dark map', shapes(DARK_MAP), DARK_MAP.background],
  ['plans on the light map', shapes(LIGHT_MAP), LIGHT_MAP.background],
])('the colours of %s', (_, colours, background) => {
  it.each(Object.entries(SIGHTS))('differ with sight: %s', (__, sight) => {
    const [difference, one, other] = closest(colours, sight);
    expect(difference, `${one} and ${other}`).toBeGreaterThan(DISTINCT);
  });

  it('are legible', () => {
    for (const each of colours) expect(contrast(each, background), each).toBeGreaterThan(LEGIBLE);
  });
});

it('the theme has the colours of series', () => {
  const names = DARK.map((_, index) => `data-${index + 1}`);
  expect(names.map((name) => token(name, 'dark'))).toEqual([...DARK]);
  expect(names.map((name) => token(name, 'light'))).toEqual([...LIGHT]);
});

it('vehicles have the colours of series', () => {
  expect([1, 2, 8, 9].map((system) => vehicleColour(system, true))).toEqual(
    [0, 1, 7, 0].map((index) => seriesColour(index, true)),
  );
});
