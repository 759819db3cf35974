/** Symbols of vehicles, one shape per kind, drawn with the nose upwards around (0, 0) in a square of 32 pixels. */

export type SymbolKind =
  | 'copter'
  | 'helicopter'
  | 'plane'
  | 'vtol'
  | 'rover'
  | 'boat'
  | 'sub'
  | 'balloon'
  | 'tracker'
  | 'unknown';

const PLANE =
  'M0-14C1.500-14 2-11 2-8.500V-3L14 4V7L2 4V9L6 12V14L0 12.500-6 14V12L-2 9V4L-14 ' +
  '7V4L-2-3V-8.500C-2-11-1.500-14 0-14Z';

const rotor = (x: number, y: number, radius: number): string =>
  `M${x - radius} ${y}a${radius} ${radius} 0 1 0 ${2 * radius} 0a${radius} ${radius} 0 1 0 ${-2 * radius} 0Z`;

const PATHS: Readonly<Record<SymbolKind, string>> = {
  copter:
    `M0-12 4.500-4.500V5.500L0 8-4.500 5.500V-4.500Z` +
    rotor(-9.5, -8.5, 4.6) +
    rotor(9.5, -8.5, 4.6) +
    rotor(-9.5, 8.5, 4.6) +
    rotor(9.5, 8.5, 4.6),
  helicopter:
    'M0-13C3-13 4-9 4-5 4 0 1.500 2 1.500 4V10H4V13H-4V10H-1.500V4C-1.500 2-4 0-4-5-4-9-3-13 ' +
    '0-13ZM-12-6.500H12V-3.500H-12Z',
  plane: PLANE,
  vtol: PLANE + rotor(-9.5, -5, 3.4) + rotor(9.5, -5, 3.4) + rotor(-9.5, 10.5, 3.4) + rotor(9.5, 10.5, 3.4),
  rover:
    'M0-13 6-6H8V-9H11V-1H8V3H11V11H8V10C8 11.500 7 12.500 5.500 12.500H-5.500C-7 12.500-8 11.500-8 ' +
    '10V11H-11V3H-8V-1H-11V-9H-8V-6H-6Z',
  boat: 'M0-14C5-8 6.500-3 6.500 3V12H-6.500V3C-6.500-3-5-8 0-14Z',
  sub: 'M0-14C3.500-14 5-10 5-6V5C5 8 3.500 10 2 11.500H6V14H-6V11.500H-2C-3.500 10-5 8-5 5V-6C-5-10-3.500-14 0-14Z',
  balloon: 'M0-13C6-13 9.500-9 9.500-4 9.500 1 5 5 3 7.500V13H-3V7.500C-5 5-9.500 1-9.500-4-9.500-9-6-13 0-13Z',
  tracker: 'M0-13 3-6H11L4 3V12H8V14H-8V12H-4V3L-11-6H-3Z',
  unknown: 'M0-13 10 12 0 6.500-10 12Z',
};

const SAME: Readonly<Record<string, SymbolKind>> = { blimp: 'balloon', rocket: 'unknown' };

/** Return the kind of symbol of a vehicle type; types without a shape of their own get an arrow. */
export function symbolKind(vehicleType: string): SymbolKind {
  if (vehicleType in PATHS) return vehicleType as SymbolKind;
  return SAME[vehicleType] ?? 'unknown';
}

const shapes = new Map<SymbolKind, Path2D>();

/** Return the shape of a symbol, made once. */
export function symbolShape(kind: SymbolKind): Path2D {
  const known = shapes.get(kind);
  if (known !== undefined) return known;
  const shape = new Path2D(PATHS[kind]);
  shapes.set(kind, shape);
  return shape;
}
