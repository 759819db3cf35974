/** Missions, fences and rally points on the map. Kinds differ by letters and dashes, not by colour only. */
import type { Place } from './geometry';
import type { FenceShape, MissionPath, Stop, StopKind } from './plan';
import type { Point } from './projection';
import { disc, label, polyline, type Drawing } from './drawing';

const LETTERS: Readonly<Partial<Record<StopKind, string>>> = {
  takeoff: 'T',
  land: 'L',
  rtl: 'R',
  interest: '◉',
};

export interface MissionStyle {
  /** Sequence number that the vehicle flies to now. */
  readonly current?: number | null;
  readonly selected?: readonly number[];
  /** Thin and without numbers, for missions of vehicles that are not selected. */
  readonly isFaint?: boolean;
  readonly colour?: string;
}

/** Paint a mission: line with arrows, stops with their numbers, loiter circles, jumps. */
export function paintMission(drawing: Drawing, path: MissionPath, style: MissionStyle = {}): void {
  const { context, projection, palette } = drawing;
  const colour = style.colour ?? palette.mission;
  const pixels = path.line.map((place) => projection.toPixel(place.latitude, place.longitude));
  context.save();
  if (style.isFaint) context.globalAlpha = 0.4;
  polyline(drawing, pixels, { colour, width: style.isFaint ? 1.5 : 2.4, hasHalo: !style.isFaint });
  if (!style.isFaint) {
    for (let index = 1; index < pixels.length; index += 1) arrow(drawing, pixels[index - 1]!, pixels[index]!, colour);
    for (const [from, to] of path.jumps) {
      const ends = [from, to].map((place) => projection.toPixel(place.latitude, place.longitude));
      polyline(drawing, ends, { colour, width: 1.5, dash: [3, 6] });
    }
    for (const stop of path.stops) paintStop(drawing, stop, style, colour);
  }
  context.restore();
}

function arrow({ context }: Drawing, from: Point, to: Point, colour: string): void {
  const [right, down] = [to.x - from.x, to.y - from.y];
  if (Math.hypot(right, down) < 60) return;
  context.save();
  context.translate((from.x + to.x) / 2, (from.y + to.y) / 2);
  context.rotate(Math.atan2(down, right));
  context.fillStyle = colour;
  context.beginPath();
  context.moveTo(7, 0);
  context.lineTo(-5, -5);
  context.lineTo(-2, 0);
  context.lineTo(-5, 5);
  context.fill();
  context.restore();
}

function paintStop(drawing: Drawing, stop: Stop, style: MissionStyle, colour: string): void {
  const { projection, palette } = drawing;
  const pixel = projection.toPixel(stop.latitude, stop.longitude);
  if (!projection.isVisible(pixel, 40)) return;
  if (stop.radius !== null && stop.radius !== 0) ring(drawing, stop, Math.abs(stop.radius), colour, [6, 5]);
  const isCurrent = style.current === stop.seq;
  const isSelected = style.selected?.includes(stop.seq) ?? false;
  const radius = isCurrent || isSelected ? 12.5 : 10.5;
  const text = LETTERS[stop.kind] ?? String(stop.seq);
  const filled = isCurrent ? colour : isSelected ? palette.accent : palette.halo;
  const textColour = isCurrent || isSelected ? (palette.isDark ? '#0b1118' : '#ffffff') : palette.text;
  disc(drawing, pixel, radius, { fill: filled, outline: isSelected ? palette.accent : colour, text, textColour });
}

function ring(drawing: Drawing, centre: Place, metres: number, colour: string, dash: readonly number[] = []): void {
  const { context, projection } = drawing;
  const { x, y } = projection.toPixel(centre.latitude, centre.longitude);
  context.save();
  context.beginPath();
  context.arc(x, y, metres * projection.pixelsPerMetre(centre.latitude), 0, 2 * Math.PI);
  context.setLineDash([...dash]);
  context.lineWidth = 1.8;
  context.strokeStyle = colour;
  context.stroke();
  context.restore();
}

/** Paint the shapes of a fence: inclusions as solid lines, exclusions dashed and filled. */
export function paintFence(drawing: Drawing, shapes: readonly FenceShape[]): void {
  const { context, projection, palette } = drawing;
  for (const shape of shapes) {
    if (shape.kind === 'return') {
      const pixel = projection.toPixel(shape.place.latitude, shape.place.longitude);
      disc(drawing, pixel, 9, { fill: palette.halo, outline: palette.fenceIn, text: 'F' });
      continue;
    }
    const colour = shape.isInclusion ? palette.fenceIn : palette.fenceOut;
    const fill = shape.isInclusion ? undefined : `${colour}2e`;
    const dash = shape.isInclusion ? [] : [8, 5];
    if (shape.kind === 'polygon') {
      const corners = shape.corners.map((place) => projection.toPixel(place.latitude, place.longitude));
      polyline(drawing, corners, { colour, width: 2.2, dash, isClosed: true, ...(fill === undefined ? {} : { fill }) });
      continue;
    }
    ring(drawing, shape.centre, shape.radius, colour, dash);
    if (fill !== undefined) {
      context.fillStyle = fill;
      const { x, y } = projection.toPixel(shape.centre.latitude, shape.centre.longitude);
      context.beginPath();
      context.arc(x, y, shape.radius * projection.pixelsPerMetre(shape.centre.latitude), 0, 2 * Math.PI);
      context.fill();
    }
  }
}

/** Paint rally points: discs with an R and their number. */
export function paintRally(drawing: Drawing, places: readonly Place[]): void {
  const { projection, palette } = drawing;
  places.forEach((place, index) => {
    const pixel = projection.toPixel(place.latitude, place.longitude);
    disc(drawing, pixel, 10, { fill: palette.halo, outline: palette.rally, text: `R${index + 1}` });
  });
}

/** Paint a home position: a disc with an H, and the vehicle's number beside it if several are shown. */
export function paintHome(drawing: Drawing, place: Place, caption = ''): void {
  const { projection, palette } = drawing;
  const pixel = projection.toPixel(place.latitude, place.longitude);
  disc(drawing, pixel, 9.5, { fill: palette.halo, outline: palette.home, text: 'H' });
  if (caption !== '') label(drawing, caption, { x: pixel.x + 16, y: pixel.y - 9 }, { size: 11 });
}

/** Paint a measured line with its length beside its end; without an end its start alone. */
export function paintRuler(drawing: Drawing, from: Place, to: Place | null, caption: string): void {
  const { projection, palette } = drawing;
  const start = projection.toPixel(from.latitude, from.longitude);
  if (to !== null) {
    const end = projection.toPixel(to.latitude, to.longitude);
    polyline(drawing, [start, end], { colour: palette.text, width: 2, dash: [2, 6], hasHalo: true });
    disc(drawing, end, 4, { fill: palette.text, outline: palette.halo });
    label(drawing, caption, { x: (start.x + end.x) / 2, y: (start.y + end.y) / 2 - 12 });
  }
  disc(drawing, start, 4, { fill: palette.halo, outline: palette.text });
}

/** Paint a place that was commanded: a cross hair, with the circle of an orbit if it has a radius. */
export function paintTarget(drawing: Drawing, place: Place, caption: string, radius: number | null = null): void {
  const { context, projection, palette } = drawing;
  const { x, y } = projection.toPixel(place.latitude, place.longitude);
  if (radius !== null) ring(drawing, place, radius, palette.accent, [7, 5]);
  for (const [colour, width] of [
    [palette.halo, 5],
    [palette.accent, 2.2],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    context.arc(x, y, 9, 0, 2 * Math.PI);
    for (const [right, down] of [
      [1, 0],
      [-1, 0],
      [0, 1],
      [0, -1],
    ] as const) {
      context.moveTo(x + right * 5, y + down * 5);
      context.lineTo(x + right * 15, y + down * 15);
    }
    context.stroke();
  }
  label(drawing, caption, { x, y: y - 25 }, { size: 12, colour: palette.accent });
}
