/** Graticule with its labels at the edges, and the scale bar. */
import { angleText, graticule, scaleLength } from './graticule';
import { label, polyline, type Drawing } from './drawing';
import type { Insets } from './geometry';

/** Pixels between labels of longitudes. */
const MIN_LABEL_GAP = 90;

/** Paint the lines of latitude and longitude. */
export function paintGrid(drawing: Drawing, insets: Insets): void {
  const { projection, palette } = drawing;
  const { width, height, bearing } = projection.view;
  const { step, latitudes, longitudes } = graticule(projection.bounds());
  const bounds = projection.bounds();
  const isTurned = Math.abs(bearing % 360) > 0.5;
  for (const latitude of latitudes) {
    const ends = [bounds.west, bounds.east].map((longitude) => straight(drawing, latitude, longitude));
    polyline(drawing, ends, { colour: palette.grid, width: 1 });
    const y = ends[0]!.y;
    if (isTurned || y < insets.top + 24 || y > height - insets.bottom - 60) continue;
    label(drawing, angleText(latitude, step, 'latitude'), { x: insets.left + 10, y: y - 8 }, small(drawing, 'left'));
  }
  const gap = longitudes.length < 2 ? Infinity : straight(drawing, 0, step).x - straight(drawing, 0, 0).x;
  const every = Math.max(1, Math.ceil(MIN_LABEL_GAP / Math.max(1, gap)));
  for (const longitude of longitudes) {
    const ends = [bounds.south, bounds.north].map((latitude) => straight(drawing, latitude, longitude));
    polyline(drawing, ends, { colour: palette.grid, width: 1 });
    const x = ends[0]!.x;
    if (isTurned || x < insets.left + 60 || x > width - insets.right - 70) continue;
    if (Math.round(longitude / step) % every !== 0) continue;
    label(
      drawing,
      angleText(longitude, step, 'longitude'),
      { x: x + 5, y: height - insets.bottom - 10 },
      small(drawing, 'left'),
    );
  }
}

/** The pixel of a place without the step to the nearest copy of the world, which would bend lines across it. */
function straight({ projection }: Drawing, latitude: number, longitude: number): { x: number; y: number } {
  const { longitude: middle, width } = projection.view;
  const pixel = projection.toPixel(latitude, middle);
  const world = 512 * 2 ** projection.view.zoom;
  const right = ((longitude - middle) / 360) * world;
  const angle = (-projection.view.bearing * Math.PI) / 180;
  return width === 0 ? pixel : { x: pixel.x + right * Math.cos(angle), y: pixel.y + right * Math.sin(angle) };
}

function small(
  { palette }: Drawing,
  align: CanvasTextAlign,
): { size: number; weight: number; align: CanvasTextAlign; colour: string } {
  const colour = palette.isDark ? 'rgba(200, 216, 234, 0.62)' : 'rgba(40, 58, 82, 0.72)';
  return { size: 10.5, weight: 500, align, colour };
}

/** Paint the scale bar at the lower left; `formatLength` writes metres as the user reads them. */
export function paintScale(drawing: Drawing, insets: Insets, formatLength: (metres: number) => string): void {
  const { context, projection, palette } = drawing;
  const { height, latitude } = projection.view;
  const perMetre = projection.pixelsPerMetre(latitude);
  const metres = scaleLength(perMetre, 120);
  const [x, y, length] = [14 + insets.left, height - 30 - insets.bottom, metres * perMetre];
  const points = [
    { x, y: y - 5 },
    { x, y },
    { x: x + length, y },
    { x: x + length, y: y - 5 },
  ];
  context.save();
  context.lineCap = 'butt';
  polyline(drawing, points, { colour: palette.text, width: 1.4, hasHalo: true });
  context.restore();
  label(drawing, formatLength(metres), { x: x + length / 2, y: y - 10 }, { size: 10.5 });
}
