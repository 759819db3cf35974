/** `QGC WPL` files of Mission Planner and MAVProxy; the first item of version 110 is the home. */

import { MavCmd, MavFrame } from '$generated';

import { fenceAreas, fenceItems, rallyItems, rallyPoints } from '../logic/fence';
import { EMPTY_PLAN, item, withoutKept, withParam, type Item, type Plan, type PlanKind } from '../logic/model';
import { PlanFileError } from './json';
import type { ReadPlan } from './qgc';

const HEADER = /^QGC WPL (\d+)$/i;
const COLUMNS = 12;
const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$/;
/** Frames of latitude and longitude. */
const GLOBAL: ReadonlySet<number> = new Set([
  MavFrame.GLOBAL,
  MavFrame.GLOBAL_RELATIVE_ALT,
  MavFrame.GLOBAL_TERRAIN_ALT,
]);

export function isWaypoints(text: string): boolean {
  return /^(\s*(#.*)?\n)*\s*QGC\s+WPL/i.test(text);
}

/** Returns the text of one kind of plan, since the format holds no more. */
export function writeWaypoints(whole: Plan, kind: PlanKind = 'mission'): string {
  const plan = withoutKept(whole);
  const shifted = withJumpsShifted(plan.mission, 1);
  const { latitude, longitude, altitude } = plan.home ?? { latitude: 0, longitude: 0, altitude: 0 };
  const home = item(MavCmd.NAV_WAYPOINT, [0, 0, 0, 0, latitude, longitude, altitude], MavFrame.GLOBAL);
  if (kind === 'mission') return lines([home, ...shifted], 0);
  return lines(kind === 'fence' ? fenceItems(plan) : rallyItems(plan.rally), 1);
}

/** Jumps count the home as item 0 in the file, and do not in the plan. */
function withJumpsShifted(items: readonly Item[], by: number): Item[] {
  return items.map((each) => {
    const target = each.params[0];
    return each.command === MavCmd.DO_JUMP && target != null ? withParam(each, 1, target + by) : each;
  });
}

function lines(items: readonly Item[], first: number): string {
  const rows = items.map((each, index) => {
    const params = each.params.map((value) => (value === null ? 'nan' : String(value)));
    const number = index + first;
    return [number, Number(number === 0), each.frame, each.command, ...params, Number(each.autocontinue)].join('\t');
  });
  return `${['QGC WPL 110', ...rows].join('\n')}\n`;
}

/** Reads a file; throws `PlanFileError` with the line of what is wrong. */
export function readWaypoints(text: string): ReadPlan {
  const [header, ...rows] = contentOf(text);
  const version = HEADER.exec(header?.words.join(' ') ?? '')?.[1];
  if (version !== '110' && version !== '120') {
    throw new PlanFileError(`line ${header?.number ?? 1}: QGC WPL ${version ?? ''} is not supported, only 110 and 120`);
  }
  const items = rows.map(readRow);
  const kind = kindOf(items);
  // Mission Planner writes the home before the points of a fence too.
  const { home, mission } = missionOf(items, version);
  if (kind === 'rally') return { plan: { ...EMPTY_PLAN, home, rally: rallyPoints(mission) }, notes: [] };
  if (kind === 'fence') {
    const { problems, ...areas } = fenceAreas(mission);
    return { plan: { ...EMPTY_PLAN, home, ...areas }, notes: problems };
  }
  return { plan: { ...EMPTY_PLAN, home, mission }, notes: [] };
}

function kindOf(items: readonly Item[]): PlanKind {
  const last = items.at(-1)?.command ?? 0;
  if (last === MavCmd.NAV_RALLY_POINT) return 'rally';
  return last >= MavCmd.NAV_FENCE_RETURN_POINT && last <= MavCmd.NAV_FENCE_CIRCLE_EXCLUSION ? 'fence' : 'mission';
}

function missionOf(items: readonly Item[], version: string): Pick<Plan, 'home' | 'mission'> {
  const first = items[0];
  // Mission Planner writes an empty item if it does not know the home.
  const isHome =
    version === '110' && (first?.command === MavCmd.NAV_WAYPOINT || first?.command === 0) && GLOBAL.has(first.frame);
  if (!first || !isHome) return { home: null, mission: items };
  const [latitude, longitude, altitude] = first.params.slice(4);
  const known = latitude != null && longitude != null && (latitude !== 0 || longitude !== 0);
  const mission = withJumpsShifted(items.slice(1), -1);
  return { home: known ? { latitude, longitude, altitude: altitude ?? 0 } : null, mission };
}

interface Line {
  /** From 1. */
  readonly number: number;
  readonly words: readonly string[];
}

/** Returns the lines with content: words separated by blanks, tabs or commas, without comments. */
function contentOf(text: string): Line[] {
  const lines = text.split('\n').map((line, index) => ({
    number: index + 1,
    words: line
      .replace(/#.*/, '')
      .split(/[\s,]+/)
      .filter(Boolean),
  }));
  return lines.filter(({ words }) => words.length > 0);
}

function readRow({ words, number: line }: Line): Item {
  if (words.length !== COLUMNS) throw new PlanFileError(`line ${line}: has ${words.length} columns instead of 12`);
  const values = words.map((word, index) => {
    const value = Number(word);
    if (/^[+-]?nan$/i.test(word) && index >= 4 && index < 11) return null;
    const isParam = index >= 4 && index < 11;
    if (!NUMBER.test(word) || !Number.isFinite(value) || (!isParam && !Number.isInteger(value)))
      throw new PlanFileError(`line ${line}: ${word.slice(0, 40)} is not a number`);
    return value;
  });
  const read = item(values[3]!, values.slice(4, 11), values[2]!);
  return { ...read, autocontinue: values[11] !== 0 };
}
