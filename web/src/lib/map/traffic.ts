/** Other aircraft, as ADS-B receivers on vehicles report them (ADSB_VEHICLE). */
import { AdsbFlags } from '$generated';

import type { Place } from './geometry';
import { label, polyline, type Drawing } from './drawing';
import { symbolShape } from './symbols';

export interface Aircraft extends Place {
  /** ICAO address. */
  readonly address: number;
  readonly callsign: string;
  /** Metres, or null. */
  readonly altitude: number | null;
  /** Degrees, or null. */
  readonly heading: number | null;
  /** m/s over ground, or null. */
  readonly speed: number | null;
  /** m/s, up is positive, or null. */
  readonly climbRate: number | null;
  /** Time of the report in ms since 1970. */
  readonly time: number;
}

/** Reports older than this are of no use. */
export const TRAFFIC_TIMEOUT = 60_000;

/** Return the aircraft of the fields of ADSB_VEHICLE, or null if its position is not valid. */
export function aircraftFrom(fields: Readonly<Record<string, unknown>>, time: number): Aircraft | null {
  const number = (name: string): number => Number(fields[name] ?? 0);
  const flags = number('flags');
  if ((flags & AdsbFlags.VALID_COORDS) === 0) return null;
  const valid = (flag: number, value: number): number | null => ((flags & flag) === 0 ? null : value);
  const address = number('ICAO_address');
  const callsign = (flags & AdsbFlags.VALID_CALLSIGN) === 0 ? '' : String(fields.callsign ?? '').trim();
  return {
    address,
    callsign: callsign === '' ? address.toString(16).toUpperCase().padStart(6, '0') : callsign,
    latitude: number('lat') / 1e7,
    longitude: number('lon') / 1e7,
    altitude: valid(AdsbFlags.VALID_ALTITUDE, number('altitude') / 1000),
    heading: valid(AdsbFlags.VALID_HEADING, number('heading') / 100),
    speed: valid(AdsbFlags.VALID_VELOCITY, number('hor_velocity') / 100),
    climbRate: valid(AdsbFlags.VERTICAL_VELOCITY_VALID, number('ver_velocity') / 100),
    time,
  };
}

/** Paint traffic: hollow aeroplanes with call sign, altitude relative to `altitude` in hundreds of metres. */
export function paintTraffic(drawing: Drawing, traffic: Iterable<Aircraft>, altitude: number | null): void {
  const { context, projection, palette } = drawing;
  for (const aircraft of traffic) {
    const pixel = projection.toPixel(aircraft.latitude, aircraft.longitude);
    if (!projection.isVisible(pixel, 40)) continue;
    context.save();
    context.translate(pixel.x, pixel.y);
    context.rotate((((aircraft.heading ?? 0) - projection.view.bearing) * Math.PI) / 180);
    context.scale(0.8, 0.8);
    const shape = symbolShape('plane');
    context.lineWidth = 5;
    context.strokeStyle = palette.halo;
    context.stroke(shape);
    context.lineWidth = 2;
    context.strokeStyle = palette.traffic;
    context.stroke(shape);
    context.restore();
    const style = { size: 10.5, colour: palette.traffic };
    label(drawing, aircraft.callsign, { x: pixel.x, y: pixel.y + 20 }, style);
    label(drawing, relativeAltitude(aircraft, altitude), { x: pixel.x, y: pixel.y + 33 }, style);
    paintAhead(drawing, aircraft, pixel);
  }
}

function paintAhead(drawing: Drawing, { speed, heading, latitude }: Aircraft, pixel: { x: number; y: number }): void {
  if (speed === null || heading === null) return;
  const length = speed * 30 * drawing.projection.pixelsPerMetre(latitude);
  const angle = ((heading - drawing.projection.view.bearing) * Math.PI) / 180;
  if (length < 14) return;
  const tip = { x: pixel.x + length * Math.sin(angle), y: pixel.y - length * Math.cos(angle) };
  polyline(drawing, [pixel, tip], { colour: drawing.palette.traffic, width: 1.2, dash: [2, 5] });
}

/** Return the altitude of traffic relative to the own vehicle, with an arrow if it climbs or sinks: `+120 m ↑`. */
export function relativeAltitude(aircraft: Aircraft, altitude: number | null): string {
  if (aircraft.altitude === null) return '– m';
  const metres = Math.round(aircraft.altitude - (altitude ?? 0));
  const sign = altitude !== null && metres >= 0 ? '+' : '';
  const climb = aircraft.climbRate ?? 0;
  return `${sign}${metres} m${climb > 0.5 ? ' ↑' : climb < -0.5 ? ' ↓' : ''}`;
}
