/** Vertical tapes for speed and altitude, and the scale of vertical speed. */
import { type Box, type Context, drawLine, drawReadout, drawText, fillPolygon, inside } from './box';
import { isKnown, type Reading, reading, tapeScale, tapeTicks, type TapeScale, verticalSpeedOffset } from './numbers';
import type { InstrumentPalette } from './palette';

export interface TapeReading {
  readonly value: Reading;
  /** The value that the pilot asked for, drawn as a bug; null if there is none. */
  readonly target?: Reading;
  readonly label: string;
  readonly unit: string;
  readonly decimals?: number;
  /** The side on which the readings stand. The ticks point to the other side, towards the horizon. */
  readonly side: 'left' | 'right';
  readonly scales: readonly TapeScale[];
}

const TITLE_HEIGHT = 18;

function drawTicks(context: Context, box: Box, tape: TapeReading, value: number, palette: InstrumentPalette): void {
  const scale = tapeScale(value, tape.scales);
  const perUnit = box.height / (2 * scale.halfSpan);
  const centre = box.y + box.height / 2;
  const [edge, inward] = tape.side === 'left' ? [box.x + box.width, -1] : [box.x, 1];
  const size = Math.max(10, Math.min(13, box.width / 4.6));
  context.strokeStyle = palette.line;
  context.lineWidth = 1;
  for (const tick of tapeTicks(value, scale.halfSpan, scale.minor, scale.majorEvery)) {
    const y = centre - tick.offset * perUnit;
    drawLine(context, edge, y, edge + inward * (tick.isMajor ? 9 : 5), y);
    if (!tick.isMajor) continue;
    const align = tape.side === 'left' ? 'right' : 'left';
    drawText(context, String(tick.value), edge + inward * 13, y, { size, colour: palette.text, align });
  }
  if (isKnown(tape.target)) {
    const limit = box.height / 2;
    const y = centre - Math.max(-limit, Math.min(limit, (tape.target - value) * perUnit));
    context.fillStyle = palette.bug;
    fillPolygon(context, [
      [edge, y],
      [edge + inward * 8, y - 7],
      [edge + inward * 8, y + 7],
    ]);
  }
}

/** Draw a tape into `box`: title, moving scale, and the value in a box at the centre. */
export function drawTape(context: Context, box: Box, tape: TapeReading, palette: InstrumentPalette): void {
  inside(context, box, () => {
    context.fillStyle = palette.panel;
    context.fillRect(box.x, box.y, box.width, box.height);
    if (isKnown(tape.value)) drawTicks(context, box, tape, tape.value, palette);
    const readout = { x: box.x + 2, y: box.y + box.height / 2 - 13, width: box.width - 4, height: 26 };
    drawReadout(context, readout, reading(tape.value, tape.decimals ?? 0), palette);
    context.fillStyle = palette.outline;
    context.fillRect(box.x, box.y, box.width, TITLE_HEIGHT);
    const title = tape.unit === '' ? tape.label : `${tape.label} ${tape.unit}`;
    const size = Math.min(11, (box.width / Math.max(title.length, 4)) * 1.7);
    drawText(context, title, box.x + box.width / 2, box.y + TITLE_HEIGHT / 2, { size, colour: palette.faint });
  });
}

/** Draw the vertical speed into `box`: a bar from the middle, compressed towards `full` at its ends. */
export function drawVerticalSpeed(
  context: Context,
  box: Box,
  rate: Reading,
  full: number,
  palette: InstrumentPalette,
): void {
  inside(context, box, () => {
    context.fillStyle = palette.panel;
    context.fillRect(box.x, box.y, box.width, box.height);
    const centre = box.y + box.height / 2;
    const half = box.height / 2 - TITLE_HEIGHT;
    context.strokeStyle = palette.faint;
    context.lineWidth = 1;
    for (const share of [0.2, 0.5, 1]) {
      for (const sign of [-1, 1]) {
        const y = centre - verticalSpeedOffset(sign * share * full, full) * half;
        drawLine(context, box.x, y, box.x + box.width * 0.3, y);
      }
    }
    drawLine(context, box.x, centre, box.x + box.width, centre);
    if (isKnown(rate)) {
      const y = centre - verticalSpeedOffset(rate, full) * half;
      context.fillStyle = palette.aircraft;
      context.fillRect(
        box.x + box.width * 0.3,
        Math.min(y, centre),
        box.width * 0.4,
        Math.max(2, Math.abs(y - centre)),
      );
    }
    const top = !isKnown(rate) || rate >= 0;
    const y = top ? box.y + TITLE_HEIGHT / 2 : box.y + box.height - TITLE_HEIGHT / 2;
    drawText(context, reading(rate, 1, '–'), box.x + box.width / 2, y, {
      size: 10.5,
      colour: palette.text,
      weight: 600,
    });
  });
}
