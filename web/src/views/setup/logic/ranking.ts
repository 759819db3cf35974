/**
 * The rank of parameters in a search: each word of the text is looked up in the name, word by word, then in the
 * descriptions. Names are made of abbreviations, which people do not type: `return altitude` means RTL_ALT.
 */

import type { Row } from './parameters';

/** Parts of names of ArduPilot, PX4, Betaflight and iNav, and the words that they stand for. */
const ABBREVIATIONS: Readonly<Record<string, string>> = {
  ACC: 'acceleration accelerometer',
  ACCEL: 'acceleration accelerometer',
  ALT: 'altitude height',
  ANG: 'angle',
  ARM: 'arming',
  ARMING: 'arm',
  ARSPD: 'airspeed',
  BARO: 'barometer pressure',
  BAT: 'battery',
  BATT: 'battery',
  CAL: 'calibration',
  CAM: 'camera',
  CHK: 'check checks',
  COM: 'commander',
  CRT: 'critical',
  CURR: 'current',
  DIST: 'distance',
  EKF: 'estimator',
  EKF2: 'estimator',
  EK3: 'estimator',
  EN: 'enable',
  FLTMODE: 'flight mode',
  FS: 'failsafe',
  GCS: 'ground station',
  GF: 'geofence fence',
  GND: 'ground',
  GYR: 'gyroscope',
  GYRO: 'gyroscope',
  INS: 'inertial',
  LND: 'landing land',
  LOIT: 'loiter',
  MAG: 'compass magnetometer',
  MAN: 'manual',
  MAX: 'maximum largest',
  MIN: 'minimum smallest',
  MIS: 'mission',
  MNT: 'mount gimbal',
  MOT: 'motor motors',
  MPC: 'multicopter position',
  NAV: 'navigation',
  OFS: 'offset',
  PIT: 'pitch',
  POS: 'position',
  PWM: 'pulse output',
  RAD: 'radius',
  RC: 'radio control receiver',
  RET: 'return',
  RLL: 'roll',
  RNGFND: 'rangefinder distance',
  RTL: 'return launch home',
  SENS: 'sensor',
  SPD: 'speed',
  SYS: 'system',
  SYSID: 'system',
  TERR: 'terrain',
  THR: 'throttle',
  TKOFF: 'takeoff',
  TO: 'takeoff',
  VEL: 'velocity speed',
  VOLT: 'voltage',
  VIB: 'vibration',
  WP: 'waypoint',
  WPNAV: 'waypoint navigation',
  XY: 'horizontal',
  Z: 'vertical',
};

/** Points of a hit of one word, and what a hit in all words of a name is worth more. */
const POINTS = { name: 100, nameBegin: 70, meaning: 60, namePart: 40, short: 25, shortPart: 12, long: 8, longPart: 3 };
const WHOLE_NAME = 20;

/** Returns the rank of rows for a text, which is null for a row that lacks one of the words; null: no words. */
export function ranker(text: string): ((row: Row) => number | null) | null {
  const words = text
    .toLowerCase()
    .split(/[\s_]+/)
    .filter(Boolean);
  if (words.length === 0) return null;
  return ({ parameter, metadata }) => {
    const name = parameter.name.toLowerCase();
    const parts = name.split('_').filter(Boolean);
    const meanings = parts.flatMap((part) => (ABBREVIATIONS[part.toUpperCase()] ?? '').split(' ')).filter(Boolean);
    const [short, long] = [wordsOf(metadata?.short_description), wordsOf(metadata?.long_description)];
    const points = words.map((word) => {
      if (parts.includes(word)) return POINTS.name;
      if (parts.some((part) => part.startsWith(word))) return POINTS.nameBegin;
      if (meanings.some((meaning) => isSameWord(meaning, word))) return POINTS.meaning;
      if (name.includes(word)) return POINTS.namePart;
      return (
        pointsOf(short, word, POINTS.short, POINTS.shortPart) || pointsOf(long, word, POINTS.long, POINTS.longPart)
      );
    });
    if (points.includes(0)) return null;
    const hits = points.filter((each) => each >= POINTS.namePart).length;
    // Of two names with all words, the one without further parts is meant; words that descriptions have too count more.
    const further = Math.max(0, parts.length - hits);
    const described = words.filter((word) => [...short, ...long].some((each) => isSameWord(each, word))).length;
    return (
      points.reduce((sum, each) => sum + each, 0) + described + (hits === words.length ? WHOLE_NAME - 2 * further : 0)
    );
  };
}

function wordsOf(text = ''): string[] {
  return text.toLowerCase().match(/[a-z0-9]+/g) ?? [];
}

function pointsOf(texts: readonly string[], word: string, whole: number, part: number): number {
  if (texts.some((each) => isSameWord(each, word))) return whole;
  return texts.some((each) => each.includes(word)) ? part : 0;
}

/** Whether two words are one in different forms: `return`, `returns`, `returning`. */
function isSameWord(one: string, other: string): boolean {
  return stem(one) === stem(other);
}

function stem(word: string): string {
  return word.length > 4 ? word.replace(/(?:ings?|ed|es|s|e)$/, '') : word;
}
