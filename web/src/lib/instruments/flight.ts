/** Primary flight display: horizon, tapes, vertical speed and heading in one picture; and its small version. */
import { type Box, type Context, drawText } from './box';
import { drawHeadingTape } from './heading';
import { drawHorizon } from './horizon';
import { ALTITUDE_SCALES, headingText, reading, type Reading, SPEED_SCALES } from './numbers';
import type { InstrumentPalette } from './palette';
import { drawTape, drawVerticalSpeed } from './tape';

export interface FlightReading {
  /** Degrees; right wing down is positive. */
  readonly roll: Reading;
  /** Degrees; nose up is positive. */
  readonly pitch: Reading;
  /** Degrees from true north. */
  readonly heading: Reading;
  readonly course?: Reading;
  /** Bearing to home, degrees. */
  readonly home?: Reading;
  /** In `speedUnit`. */
  readonly speed: Reading;
  readonly speedTarget?: Reading;
  /** In `altitudeUnit`. */
  readonly altitude: Reading;
  readonly altitudeTarget?: Reading;
  /** In `climbUnit`; up is positive. */
  readonly climb: Reading;
}

export interface FlightUnits {
  /** Which speed it is, such as `GS` (over ground) or `AS` (through the air). */
  readonly speedLabel: string;
  readonly speedUnit: string;
  readonly altitudeLabel: string;
  readonly altitudeUnit: string;
  /** Full scale of the vertical speed. */
  readonly fullClimb: number;
}

export const METRIC: FlightUnits = {
  speedLabel: 'GS',
  speedUnit: 'm/s',
  altitudeLabel: 'ALT',
  altitudeUnit: 'm',
  fullClimb: 10,
};

export interface FlightLayout {
  readonly horizon: Box;
  readonly speed: Box;
  readonly altitude: Box;
  readonly climb: Box;
  readonly heading: Box;
}

/** Return the places of the parts in a display of this size. */
export function flightLayout(width: number, height: number): FlightLayout {
  const tape = Math.max(46, Math.min(66, width * 0.17));
  const climb = Math.max(22, Math.min(30, width * 0.075));
  const heading = Math.max(30, Math.min(38, height * 0.15));
  const middle = height - heading;
  return {
    horizon: { x: 0, y: 0, width, height: middle },
    speed: { x: 0, y: 0, width: tape, height: middle },
    altitude: { x: width - tape - climb, y: 0, width: tape, height: middle },
    climb: { x: width - climb, y: 0, width: climb, height: middle },
    heading: { x: 0, y: middle, width, height: heading },
  };
}

/** Draw the primary flight display over the whole canvas. */
export function drawFlight(
  context: Context,
  width: number,
  height: number,
  values: FlightReading,
  units: FlightUnits,
  palette: InstrumentPalette,
): void {
  const layout = flightLayout(width, height);
  // Wider to the left by the scale of vertical speed, so that its centre lies between the two tapes.
  const { horizon, climb } = layout;
  drawHorizon(context, { ...horizon, x: -climb.width, width: width + climb.width }, values, palette);
  const { speed, speedTarget, altitude, altitudeTarget } = values;
  drawTape(
    context,
    layout.speed,
    {
      value: speed,
      target: speedTarget,
      label: units.speedLabel,
      unit: units.speedUnit,
      decimals: 1,
      side: 'left',
      scales: SPEED_SCALES,
    },
    palette,
  );
  drawTape(
    context,
    layout.altitude,
    {
      value: altitude,
      target: altitudeTarget,
      label: units.altitudeLabel,
      unit: units.altitudeUnit,
      decimals: 1,
      side: 'right',
      scales: ALTITUDE_SCALES,
    },
    palette,
  );
  drawVerticalSpeed(context, climb, values.climb, units.fullClimb, palette);
  context.fillStyle = palette.skyHigh;
  context.fillRect(layout.heading.x, layout.heading.y, layout.heading.width, layout.heading.height);
  drawHeadingTape(context, layout.heading, values, palette);
}

/** Draw the small heads-up display of one vehicle among many: horizon, speed, altitude, heading. */
export function drawHeadsUp(
  context: Context,
  width: number,
  height: number,
  values: FlightReading,
  palette: InstrumentPalette,
): void {
  drawHorizon(context, { x: 0, y: 0, width, height }, values, palette, true);
  const size = 11.5;
  const label = (text: string, x: number, y: number, align: CanvasTextAlign): void => {
    context.font = `600 ${size}px system-ui, sans-serif`;
    const half = context.measureText(text).width + 8;
    context.fillStyle = palette.panel;
    const left = align === 'left' ? x - 4 : align === 'right' ? x - half + 4 : x - half / 2;
    context.fillRect(left, y - 8, half, 16);
    drawText(context, text, x, y, { size, colour: palette.text, align, weight: 600 });
  };
  label(reading(values.speed, 1, '–'), 6, height / 2, 'left');
  label(reading(values.altitude, 1, '–'), width - 6, height / 2, 'right');
  label(headingText(values.heading, '–'), width / 2, 10, 'center');
}

/** Return the description of a flight display for people who do not see it. */
export function describeFlight(values: FlightReading, units: FlightUnits): string {
  return [
    `heading ${headingText(values.heading, 'unknown')}`,
    `altitude ${reading(values.altitude, 0, 'unknown')} ${units.altitudeUnit}`,
    `speed ${reading(values.speed, 0, 'unknown')} ${units.speedUnit}`,
    `roll ${reading(values.roll, 0, 'unknown')}°`,
    `pitch ${reading(values.pitch, 0, 'unknown')}°`,
  ].join(', ');
}
