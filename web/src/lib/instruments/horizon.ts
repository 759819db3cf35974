/** Artificial horizon: sky and ground turn and shift behind a fixed aircraft symbol, as in every flight display. */
import { type Box, type Context, drawLine, drawText, fillPolygon, inside } from './box';
import { DASHES, isKnown, type Reading } from './numbers';
import type { InstrumentPalette } from './palette';

export interface HorizonReading {
  /** Degrees; right wing down is positive. */
  readonly roll: Reading;
  /** Degrees; nose up is positive. */
  readonly pitch: Reading;
}

const ROLL_MARKS = [-60, -45, -30, -20, -10, 0, 10, 20, 30, 45, 60];
/** Degrees of pitch between the top and the bottom edge. */
const PITCH_SPAN = 55;

/** Return pixels for each degree of pitch. */
export function pitchScale(height: number): number {
  return height / PITCH_SPAN;
}

/** Return the rungs of the pitch ladder that can be seen: degrees and half width relative to the instrument's. */
export function pitchLadder(pitch: number, compact: boolean): { degrees: number; halfWidth: number }[] {
  const step = compact ? 10 : 5;
  const rungs = [];
  for (let degrees = -90; degrees <= 90; degrees += step) {
    // Rungs end below the roll scale.
    if (degrees === 0 || Math.abs(degrees - pitch) > (compact ? PITCH_SPAN / 2 : 17)) continue;
    rungs.push({ degrees, halfWidth: degrees % 10 === 0 ? 0.13 : 0.065 });
  }
  return rungs;
}

function drawBackground(context: Context, reach: number, offset: number, palette: InstrumentPalette): void {
  const sky = context.createLinearGradient(0, offset - reach * 0.6, 0, offset);
  sky.addColorStop(0, palette.skyHigh);
  sky.addColorStop(1, palette.skyLow);
  context.fillStyle = sky;
  context.fillRect(-reach, offset - 4 * reach, 2 * reach, 4 * reach);
  const ground = context.createLinearGradient(0, offset, 0, offset + reach * 0.6);
  ground.addColorStop(0, palette.groundHigh);
  ground.addColorStop(1, palette.groundLow);
  context.fillStyle = ground;
  context.fillRect(-reach, offset, 2 * reach, 4 * reach);
  context.strokeStyle = palette.line;
  context.lineWidth = 1.5;
  drawLine(context, -reach, offset, reach, offset);
}

function drawLadder(context: Context, box: Box, pitch: number, compact: boolean, palette: InstrumentPalette): void {
  const scale = pitchScale(box.height);
  const size = Math.max(9, Math.min(13, box.height / 22));
  context.strokeStyle = palette.line;
  context.lineWidth = 1.2;
  for (const rung of pitchLadder(pitch, compact)) {
    const y = (pitch - rung.degrees) * scale;
    const half = rung.halfWidth * Math.min(box.width, box.height * 1.4);
    drawLine(context, -half, y, half, y);
    if (compact || rung.degrees % 10 !== 0) continue;
    const label = String(Math.abs(rung.degrees));
    drawText(context, label, -half - size, y, { size, colour: palette.text });
    drawText(context, label, half + size, y, { size, colour: palette.text });
  }
}

function drawRollScale(context: Context, radius: number, roll: number, palette: InstrumentPalette): void {
  context.strokeStyle = palette.line;
  context.fillStyle = palette.line;
  context.lineWidth = 1.4;
  context.beginPath();
  context.arc(0, 0, radius, (-150 * Math.PI) / 180, (-30 * Math.PI) / 180);
  context.stroke();
  for (const mark of ROLL_MARKS) {
    const angle = (mark * Math.PI) / 180;
    const length = mark % 30 === 0 ? 9 : 5;
    const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
    drawLine(context, radius * sine, -radius * cosine, (radius + length) * sine, -(radius + length) * cosine);
  }
  context.save();
  context.rotate((-roll * Math.PI) / 180);
  fillPolygon(context, [
    [0, -radius + 1],
    [-6, -radius + 11],
    [6, -radius + 11],
  ]);
  context.restore();
}

/** The symbol of the aircraft: two wings and a dot, dark outlined so that it is seen on sky and ground. */
function drawAircraft(context: Context, box: Box, palette: InstrumentPalette): void {
  const unit = Math.min(box.width, box.height * 1.3) / 12;
  const strokes = (colour: string, width: number): void => {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.lineCap = 'round';
    context.lineJoin = 'round';
    for (const side of [-1, 1]) {
      context.beginPath();
      context.moveTo(side * unit * 2.6, 0);
      context.lineTo(side * unit * 1.1, 0);
      context.lineTo(side * unit * 0.75, unit * 0.5);
      context.stroke();
    }
    context.beginPath();
    context.arc(0, 0, width / 4, 0, 2 * Math.PI);
    context.stroke();
  };
  const width = Math.max(2.5, unit / 5);
  strokes(palette.outline, width + 2.5);
  strokes(palette.aircraft, width);
}

function drawUnknown(context: Context, box: Box, palette: InstrumentPalette): void {
  context.fillStyle = palette.unknown;
  context.fillRect(box.x, box.y, box.width, box.height);
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  drawText(context, DASHES, x, y, { size: Math.min(24, box.height / 4), colour: palette.faint, weight: 600 });
}

/** Draw the horizon into `box`; `compact` leaves out the labels and the roll scale, for small displays. */
export function drawHorizon(
  context: Context,
  box: Box,
  { roll, pitch }: HorizonReading,
  palette: InstrumentPalette,
  compact = false,
): void {
  inside(context, box, () => {
    if (!isKnown(roll) || !isKnown(pitch)) {
      drawUnknown(context, box, palette);
      return;
    }
    const reach = Math.hypot(box.width, box.height);
    context.translate(box.x + box.width / 2, box.y + box.height / 2);
    context.save();
    context.rotate((-roll * Math.PI) / 180);
    drawBackground(context, reach, pitch * pitchScale(box.height), palette);
    drawLadder(context, box, pitch, compact, palette);
    context.restore();
    if (!compact) drawRollScale(context, Math.min(box.height * 0.4, box.width * 0.42), roll, palette);
    drawAircraft(context, box, palette);
  });
}
