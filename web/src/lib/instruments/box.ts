/** A rectangle of a canvas in CSS pixels, and the text helpers that all instruments share. */
import { FONT, type InstrumentPalette } from './palette';

export type Context = CanvasRenderingContext2D;

export interface Box {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export interface TextStyle {
  readonly size: number;
  readonly colour: string;
  readonly align?: CanvasTextAlign;
  readonly weight?: number;
}

/** Write one line of text, vertically centred on `y`. */
export function drawText(context: Context, text: string, x: number, y: number, style: TextStyle): void {
  context.font = `${style.weight ?? 500} ${style.size}px ${FONT}`;
  context.textAlign = style.align ?? 'center';
  context.textBaseline = 'middle';
  context.fillStyle = style.colour;
  context.fillText(text, x, y);
}

/** Draw inside a rectangle only, and restore the context afterwards even if `draw` fails. */
export function inside(context: Context, box: Box, draw: () => void): void {
  context.save();
  try {
    context.beginPath();
    context.rect(box.x, box.y, box.width, box.height);
    context.clip();
    draw();
  } finally {
    context.restore();
  }
}

export function drawLine(context: Context, x1: number, y1: number, x2: number, y2: number): void {
  context.beginPath();
  context.moveTo(x1, y1);
  context.lineTo(x2, y2);
  context.stroke();
}

export function fillPolygon(context: Context, points: readonly (readonly [number, number])[]): void {
  context.beginPath();
  points.forEach(([x, y], index) => (index === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  context.closePath();
  context.fill();
}

/** The dark box with a value in it that every tape has at its centre. */
export function drawReadout(context: Context, box: Box, text: string, palette: InstrumentPalette): void {
  context.fillStyle = palette.outline;
  context.strokeStyle = palette.line;
  context.lineWidth = 1;
  context.beginPath();
  context.roundRect(box.x, box.y, box.width, box.height, 3);
  context.fill();
  context.stroke();
  const size = Math.min(box.height * 0.68, (box.width / Math.max(text.length, 3)) * 1.55);
  drawText(context, text, box.x + box.width / 2, box.y + box.height / 2 + 0.5, {
    size,
    colour: palette.text,
    weight: 650,
  });
}
