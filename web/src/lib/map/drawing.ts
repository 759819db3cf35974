/** Layers of the map and the canvas above the tiles on which they paint, at most once per animation frame. */
import type { MapPalette } from './palette';
import type { Point, Projection } from './projection';
import { type Sprite, spriteOf, stamp } from './sprites';

export interface Drawing {
  readonly context: CanvasRenderingContext2D;
  readonly projection: Projection;
  readonly palette: MapPalette;
}

/** A layer paints itself; it reads the store, so that a change paints the map again. */
export type Layer = (drawing: Drawing) => void;

/** Pixels around a text for its halo. */
const MARGIN = 10;
const FONT = 'system-ui, "Segoe UI", Roboto, "Noto Sans", sans-serif';

export interface LabelStyle {
  readonly size?: number;
  readonly weight?: number;
  readonly colour?: string;
  readonly align?: CanvasTextAlign;
}

/**
 * Write text with a halo, readable on every background.
 *
 * @param text - A text, or its parts from left to right. A part is painted once and copied from then on: what changes
 *   often is a part of its own.
 */
export function label(
  drawing: Drawing,
  text: string | readonly string[],
  { x, y }: Point,
  style: LabelStyle = {},
): void {
  const { align = 'center' } = style;
  const sprites = (typeof text === 'string' ? [text] : text).map((part) => textSprite(drawing, part, style));
  const width = sprites.reduce((sum, sprite) => sum + sprite.width - MARGIN, 0);
  let left = x - (align === 'center' ? width / 2 : align === 'left' || align === 'start' ? 0 : width);
  for (const sprite of sprites) {
    const own = sprite.width - MARGIN;
    // Whole pixels keep texts sharp.
    stamp(drawing.context, sprite, Math.round(left + own / 2), Math.round(y));
    left += own;
  }
}

function textSprite({ context, palette }: Drawing, text: string, style: LabelStyle): Sprite {
  const { size = 12, weight = 600, colour = palette.text } = style;
  const font = `${weight} ${size}px ${FONT}`;
  const measure = (): [number, number] => {
    context.font = font;
    return [context.measureText(text).width + MARGIN, size + MARGIN];
  };
  return spriteOf(`${text}|${font}|${colour}|${palette.halo}`, measure, (target) => {
    target.font = font;
    target.textAlign = 'center';
    target.textBaseline = 'middle';
    target.lineJoin = 'round';
    target.lineWidth = 3.5;
    target.strokeStyle = palette.halo;
    target.strokeText(text, 0, 0);
    target.fillStyle = colour;
    target.fillText(text, 0, 0);
  });
}

export interface LineStyle {
  readonly colour: string;
  readonly width?: number;
  readonly dash?: readonly number[];
  readonly isClosed?: boolean;
  readonly fill?: string;
  readonly hasHalo?: boolean;
}

/** Draw a line through pixels. */
export function polyline({ context, palette }: Drawing, points: readonly Point[], style: LineStyle): void {
  if (points.length < 2) return;
  context.save();
  context.beginPath();
  points.forEach(({ x, y }, index) => (index === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  if (style.isClosed) context.closePath();
  context.lineJoin = 'round';
  context.lineCap = 'round';
  if (style.fill !== undefined) {
    context.fillStyle = style.fill;
    context.fill();
  }
  if (style.hasHalo) {
    context.strokeStyle = palette.halo;
    context.lineWidth = (style.width ?? 2) + 2.5;
    context.stroke();
  }
  context.setLineDash([...(style.dash ?? [])]);
  context.strokeStyle = style.colour;
  context.lineWidth = style.width ?? 2;
  context.stroke();
  context.restore();
}

/** Draw a filled disc with an outline and, if given, a text in it. */
export function disc(
  drawing: Drawing,
  { x, y }: Point,
  radius: number,
  style: { readonly fill: string; readonly outline: string; readonly text?: string; readonly textColour?: string },
): void {
  const { context } = drawing;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = style.fill;
  context.fill();
  context.lineWidth = 1.8;
  context.strokeStyle = style.outline;
  context.stroke();
  if (style.text === undefined) return;
  context.font = `700 ${style.text.length > 2 ? 9.5 : 11.5}px ${FONT}`;
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillStyle = style.textColour ?? drawing.palette.text;
  context.fillText(style.text, x, y + 0.5);
}
