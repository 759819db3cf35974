/** Vehicles on the map: symbol turned by heading, where it will be in some seconds, number, altitude. */
import type { Place } from './geometry';
import { vehicleColour } from './palette';
import type { Point, Projection } from './projection';
import { label, polyline, type Drawing } from './drawing';
import { spriteOf, stamp } from './sprites';
import { symbolKind, symbolShape } from './symbols';

export interface MapVehicle extends Place {
  readonly system: number;
  readonly type: string;
  readonly heading: number | null;
  /** m/s towards north and east, or null. */
  readonly velocity: { readonly north: number; readonly east: number } | null;
  readonly isArmed: boolean;
  readonly isAlive: boolean;
  readonly isSelected: boolean;
  /** The parts of the short text below the symbol. */
  readonly caption: readonly string[];
  /** The newest places of the vehicle's track, which the layer of tracks does not show yet; null without a track. */
  readonly trackEnd: readonly Place[] | null;
}

/** Seconds of flight that the line ahead of a vehicle stands for. */
const AHEAD = 8;
const HIT_RADIUS = 22;
const CAPTION_HEIGHT = 15;
/** Room for the symbols with their outlines; turned copies cost time for each pixel. */
const SYMBOL_SIZE = [34, 34] as const;

/** Paint all vehicles, the selected ones above the others, and captions where there is room for them. */
export function paintVehicles(drawing: Drawing, vehicles: readonly MapVehicle[]): void {
  const sorted = [...vehicles].sort((one, other) => Number(one.isSelected) - Number(other.isSelected));
  const shown: [MapVehicle, Point][] = [];
  for (const vehicle of sorted) {
    const pixel = drawing.projection.toPixel(vehicle.latitude, vehicle.longitude);
    if (!drawing.projection.isVisible(pixel, 60)) continue;
    shown.push([vehicle, pixel]);
    paintVehicle(drawing, vehicle, pixel);
  }
  const captions = shown.reverse().map(([{ caption }, { x, y }]) => ({ text: caption.join(''), x, y: y + 27 }));
  for (const index of roomFor(captions)) label(drawing, shown[index]![0].caption, captions[index]!, { size: 11.5 });
}

/** Return which captions can be written without covering an earlier one. */
export function roomFor(
  captions: readonly { readonly text: string; readonly x: number; readonly y: number }[],
): number[] {
  const taken: { x: number; y: number; half: number }[] = [];
  return captions.flatMap(({ text, x, y }, index) => {
    const half = text.length * 3.6 + 2;
    const isCovered = taken.some(
      (other) => Math.abs(other.x - x) < other.half + half && Math.abs(other.y - y) < CAPTION_HEIGHT,
    );
    if (isCovered) return [];
    taken.push({ x, y, half });
    return [index];
  });
}

function paintVehicle(drawing: Drawing, vehicle: MapVehicle, pixel: Point): void {
  const { context, projection, palette } = drawing;
  const colour = vehicleColour(vehicle.system, palette.isDark);
  if (vehicle.trackEnd !== null) {
    const tail = vehicle.trackEnd.map((place) => projection.toPixel(place.latitude, place.longitude));
    polyline(drawing, [...tail, pixel], { colour, width: 2.2 });
  }
  if (vehicle.velocity !== null && vehicle.isAlive) paintAhead(drawing, vehicle, pixel, colour);
  context.save();
  context.globalAlpha = vehicle.isAlive ? 1 : 0.5;
  if (vehicle.isSelected) {
    context.translate(pixel.x, pixel.y);
    paintSelection(drawing, colour);
    context.translate(-pixel.x, -pixel.y);
  }
  const { type, isArmed } = vehicle;
  const kind = vehicle.heading === null ? 'unknown' : type;
  paintSymbolAt(drawing, pixel, { type: kind, heading: vehicle.heading, colour, isArmed });
  context.restore();
}

/** Paint the symbol of a kind of vehicle, turned to its heading in degrees. */
export function paintSymbolAt(
  { context, projection, palette }: Drawing,
  pixel: Point,
  { type, heading, colour, isArmed }: { type: string; heading: number | null; colour: string; isArmed: boolean },
): void {
  const kind = symbolKind(type);
  const sprite = spriteOf(
    `${kind}|${colour}|${isArmed}|${palette.halo}`,
    () => SYMBOL_SIZE,
    (target) => paintSymbol(target, symbolShape(kind), colour, palette.halo, isArmed),
  );
  context.save();
  context.translate(pixel.x, pixel.y);
  context.rotate((((heading ?? 0) - projection.view.bearing) * Math.PI) / 180);
  stamp(context, sprite);
  context.restore();
}

function paintSymbol(
  context: CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D,
  shape: Path2D,
  colour: string,
  halo: string,
  isArmed: boolean,
): void {
  context.lineJoin = 'round';
  context.lineWidth = 4.5;
  context.strokeStyle = halo;
  context.stroke(shape);
  context.fillStyle = colour;
  // Disarmed vehicles are hollow, armed ones filled.
  context.globalAlpha = isArmed ? 1 : 0.32;
  context.fill(shape);
  context.globalAlpha = 1;
  context.lineWidth = 1.5;
  context.strokeStyle = isArmed ? halo : colour;
  context.stroke(shape);
}

function paintAhead(drawing: Drawing, vehicle: MapVehicle, pixel: Point, colour: string): void {
  const { north, east } = vehicle.velocity!;
  const scale = drawing.projection.pixelsPerMetre(vehicle.latitude) * AHEAD;
  const angle = (-drawing.projection.view.bearing * Math.PI) / 180;
  const [right, down] = [east * scale, -north * scale];
  if (Math.hypot(right, down) < 6) return;
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  const tip = { x: pixel.x + right * cosine - down * sine, y: pixel.y + right * sine + down * cosine };
  polyline(drawing, [pixel, tip], { colour, width: 1.6, dash: [5, 5], hasHalo: true });
}

function paintSelection({ context, palette }: Drawing, colour: string): void {
  context.beginPath();
  context.arc(0, 0, 21, 0, 2 * Math.PI);
  context.fillStyle = palette.isDark ? 'rgba(255, 255, 255, 0.08)' : 'rgba(0, 0, 0, 0.06)';
  context.fill();
  context.lineWidth = 4;
  context.strokeStyle = palette.halo;
  context.stroke();
  context.lineWidth = 2;
  context.strokeStyle = colour;
  context.stroke();
}

/** Return the vehicle at a pixel: the nearest one of those below a finger's tip. */
export function vehicleAt<Kind extends Place>(
  projection: Projection,
  vehicles: readonly Kind[],
  { x, y }: Point,
  radius: number = HIT_RADIUS,
): Kind | null {
  let [found, least]: [Kind | null, number] = [null, radius];
  for (const vehicle of vehicles) {
    const pixel = projection.toPixel(vehicle.latitude, vehicle.longitude);
    const gap = Math.hypot(pixel.x - x, pixel.y - y);
    if (gap <= least) [found, least] = [vehicle, gap];
  }
  return found;
}
