/** Levels of battery, GPS and link for their small instruments: a level has a symbol and a word beside its colour. */
import { GpsFixType } from '$generated';

import { isKnown, type Reading } from './numbers';

export type Level = 'unknown' | 'good' | 'warning' | 'critical';

/** Return the level of a battery from its charge (0 … 1), or from the volts of a cell if the charge is not known. */
export function batteryLevel(remaining: Reading, cellVoltage: Reading = null): Level {
  if (isKnown(remaining)) return remaining < 0.15 ? 'critical' : remaining < 0.3 ? 'warning' : 'good';
  if (isKnown(cellVoltage)) return cellVoltage < 3.4 ? 'critical' : cellVoltage < 3.6 ? 'warning' : 'good';
  return 'unknown';
}

const FIXES = ['no GPS', 'no fix', '2D', '3D', 'DGPS', 'RTK float', 'RTK fixed', 'static', 'PPP'];

/** Return the name of a GPS_FIX_TYPE. */
export function fixName(fix: Reading): string {
  return isKnown(fix) ? (FIXES[fix] ?? `fix ${fix}`) : '–';
}

export function gpsLevel(fix: Reading, satellites: Reading, hdop: Reading): Level {
  if (!isKnown(fix)) return 'unknown';
  if (fix < GpsFixType._3D_FIX) return 'critical';
  const isWeak = (isKnown(satellites) && satellites < 8) || (isKnown(hdop) && hdop > 2);
  return isWeak ? 'warning' : 'good';
}

/** Return the level of a link from the age of its last message in seconds and the share of messages lost. */
export function linkLevel(age: Reading, loss: Reading): Level {
  if (!isKnown(age)) return 'unknown';
  if (age > 5) return 'critical';
  if (age > 2 || (isKnown(loss) && loss > 0.1)) return 'warning';
  return 'good';
}

/** Return how many of four bars a link gets. */
export function linkBars(level: Level, loss: Reading): number {
  if (level === 'unknown' || level === 'critical') return 0;
  if (!isKnown(loss)) return 3;
  return loss > 0.3 ? 1 : loss > 0.1 ? 2 : loss > 0.02 ? 3 : 4;
}

/** Return the level of an estimate from its largest test ratio, of which 1 is the limit. */
export function estimatorLevel(ratio: Reading, isInitialized = true): Level {
  if (!isKnown(ratio)) return 'unknown';
  if (!isInitialized || ratio >= 1) return 'critical';
  return ratio > 0.6 ? 'warning' : 'good';
}

/** Return the level of vibrations in m/s²: above 30 altitudes suffer, above 60 positions do. */
export function vibrationLevel(level: Reading): Level {
  if (!isKnown(level)) return 'unknown';
  return level > 60 ? 'critical' : level > 30 ? 'warning' : 'good';
}
