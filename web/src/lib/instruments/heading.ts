/** Heading instruments: the horizontal tape of a primary flight display, and a compass rose. */
import { type Box, type Context, drawLine, drawReadout, drawText, fillPolygon, inside } from './box';
import { headingLabel, headingText, isKnown, type Reading, tapeTicks, wrap180 } from './numbers';
import type { InstrumentPalette } from './palette';

export interface HeadingReading {
  /** Degrees from true north. */
  readonly heading: Reading;
  /** Direction of travel over ground, degrees; drawn as a diamond. */
  readonly course?: Reading;
  /** Bearing to home, degrees; drawn as H. */
  readonly home?: Reading;
}

const HALF_SPAN = 60;

function drawBugs(
  context: Context,
  box: Box,
  heading: number,
  { course, home }: HeadingReading,
  palette: InstrumentPalette,
): void {
  const place = (degrees: number): number => {
    const offset = Math.max(-HALF_SPAN, Math.min(HALF_SPAN, wrap180(degrees - heading)));
    return box.x + box.width / 2 + (offset / HALF_SPAN) * (box.width / 2 - 7);
  };
  if (isKnown(course)) {
    const x = place(course);
    context.fillStyle = palette.bug;
    fillPolygon(context, [
      [x, box.y + 1],
      [x + 5, box.y + 6],
      [x, box.y + 11],
      [x - 5, box.y + 6],
    ]);
  }
  if (isKnown(home)) {
    drawText(context, 'H', place(home), box.y + 7, { size: 11, colour: palette.aircraft, weight: 750 });
  }
}

/** Draw the heading tape into `box`, with the heading in a box at its middle. */
export function drawHeadingTape(context: Context, box: Box, values: HeadingReading, palette: InstrumentPalette): void {
  inside(context, box, () => {
    context.fillStyle = palette.panel;
    context.fillRect(box.x, box.y, box.width, box.height);
    const { heading } = values;
    const bottom = box.y + box.height;
    if (isKnown(heading)) {
      context.strokeStyle = palette.line;
      context.lineWidth = 1;
      for (const tick of tapeTicks(heading, HALF_SPAN, 5, 6)) {
        const x = box.x + box.width / 2 + (tick.offset / HALF_SPAN) * (box.width / 2);
        drawLine(context, x, bottom, x, bottom - (tick.isMajor ? 8 : 4));
        if (!tick.isMajor) continue;
        const isMain = tick.value % 90 === 0;
        const style = { size: isMain ? 13 : 11, colour: isMain ? palette.text : palette.faint, weight: 600 };
        drawText(context, headingLabel(tick.value), x, bottom - 17, style);
      }
      drawBugs(context, box, heading, values, palette);
    }
    const readout = { x: box.x + box.width / 2 - 23, y: box.y + 3, width: 46, height: box.height - 6 };
    drawReadout(context, readout, headingText(heading), palette);
  });
}

/** Draw a compass rose into `box`: the card turns, the lubber line at the top stays. */
export function drawHeadingRose(context: Context, box: Box, values: HeadingReading, palette: InstrumentPalette): void {
  const radius = Math.min(box.width, box.height) / 2 - 4;
  inside(context, box, () => {
    context.translate(box.x + box.width / 2, box.y + box.height / 2);
    context.fillStyle = palette.unknown;
    context.beginPath();
    context.arc(0, 0, radius, 0, 2 * Math.PI);
    context.fill();
    if (isKnown(values.heading)) drawCard(context, radius, values.heading, values, palette);
    context.fillStyle = palette.aircraft;
    fillPolygon(context, [
      [0, -radius + 10],
      [-6, -radius - 1],
      [6, -radius - 1],
    ]);
    const text = headingText(values.heading);
    drawText(context, text, 0, 0, { size: radius / 3, colour: palette.text, weight: 650 });
  });
}

function drawCard(
  context: Context,
  radius: number,
  heading: number,
  { course, home }: HeadingReading,
  palette: InstrumentPalette,
): void {
  const at = (degrees: number, draw: () => void): void => {
    context.save();
    context.rotate(((degrees - heading) * Math.PI) / 180);
    draw();
    context.restore();
  };
  context.strokeStyle = palette.line;
  context.lineWidth = 1;
  const size = Math.max(9, radius / 6.5);
  for (let degrees = 0; degrees < 360; degrees += 10) {
    at(degrees, () => {
      drawLine(context, 0, -radius + 2, 0, -radius + (degrees % 30 === 0 ? 9 : 5));
      if (degrees % 30 !== 0) return;
      const label = degrees % 90 === 0 ? headingLabel(degrees) : String(degrees / 10);
      drawText(context, label, 0, -radius + 11 + size / 2, { size, colour: palette.text, weight: 600 });
    });
  }
  if (isKnown(course)) {
    context.fillStyle = palette.bug;
    at(course, () =>
      fillPolygon(context, [
        [0, -radius],
        [5, -radius + 6],
        [0, -radius + 12],
        [-5, -radius + 6],
      ]),
    );
  }
  if (isKnown(home)) {
    at(home, () => drawText(context, 'H', 0, -radius * 0.48, { size, colour: palette.aircraft, weight: 750 }));
  }
}
