/** `QGC WPL` files of Mission Planner and MAVProxy; the first item of version 110 is the home. */

import { fenceAreas, fenceItems, rallyItems, rallyPoints } from '../logic/fence';
import { CMD, EMPTY_PLAN, FRAME, item, withParam, type Item, type Plan, type PlanKind } from '../logic/model';
import { PlanFileError } from './json';
import type { ReadPlan } from './qgc';

const HEADER = /^QGC\s+WPL\s+(\d+)\s*$/;
const COLUMNS = 12;

export function isWaypoints(text: string): boolean {
  return /^\s*QGC\s+WPL/.test(text);
}

/** Returns the text of one kind of plan, since the format holds no more. */
export function writeWaypoints(plan: Plan, kind: PlanKind = 'mission'): string {
  const shifted = plan.mission.map((each) =>
    each.command === CMD.DO_JUMP ? withParam(each, 1, (each.params[0] ?? 0) + 1) : each,
  );
  const { latitude, longitude, altitude } = plan.home ?? { latitude: 0, longitude: 0, altitude: 0 };
  const home = item(CMD.NAV_WAYPOINT, [0, 0, 0, 0, latitude, longitude, altitude], FRAME.GLOBAL);
  if (kind === 'mission') return lines([home, ...shifted], 0);
  return lines(kind === 'fence' ? fenceItems(plan) : rallyItems(plan.rally), 1);
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
  const [header, ...rows] = text.split(/\r?\n/).filter((line) => line.trim() && !line.startsWith('#'));
  const version = HEADER.exec((header ?? '').trim())?.[1];
  if (version !== '110' && version !== '120') {
    throw new PlanFileError(`line 1: QGC WPL ${version ?? ''} is not supported, only 110 and 120`);
  }
  const items = rows.map((row, index) => readRow(row, index + 2));
  const kind = kindOf(items);
  if (kind === 'rally') return { plan: { ...EMPTY_PLAN, rally: rallyPoints(items) }, notes: [] };
  if (kind === 'fence') {
    const { problems, ...areas } = fenceAreas(items);
    return { plan: { ...EMPTY_PLAN, ...areas }, notes: problems };
  }
  return { plan: missionOf(items, version), notes: [] };
}

function kindOf(items: readonly Item[]): PlanKind {
  // Mission Planner writes the home before the points of a fence too.
  const last = items.at(-1)?.command ?? 0;
  if (last === CMD.NAV_RALLY_POINT) return 'rally';
  return last >= CMD.NAV_FENCE_RETURN_POINT && last <= CMD.NAV_FENCE_CIRCLE_EXCLUSION ? 'fence' : 'mission';
}

function missionOf(items: readonly Item[], version: string): Plan {
  const first = items[0];
  const isHome = version === '110' && first?.command === CMD.NAV_WAYPOINT;
  if (!first || !isHome) return { ...EMPTY_PLAN, mission: items };
  const [latitude, longitude, altitude] = first.params.slice(4);
  const known = latitude != null && longitude != null && (latitude !== 0 || longitude !== 0);
  const mission = items.slice(1).map((each) =>
    each.command === CMD.DO_JUMP ? withParam(each, 1, (each.params[0] ?? 0) - 1) : each,
  );
  return { ...EMPTY_PLAN, home: known ? { latitude, longitude, altitude: altitude ?? 0 } : null, mission };
}

function readRow(row: string, line: number): Item {
  const words = row.trim().split(/\s+/);
  if (words.length !== COLUMNS) throw new PlanFileError(`line ${line}: has ${words.length} columns instead of 12`);
  const values = words.map((word, index) => {
    const value = Number(word);
    if (/^[+-]?nan$/i.test(word) && index >= 4 && index < 11) return null;
    if (!Number.isFinite(value)) throw new PlanFileError(`line ${line}: ${word.slice(0, 40)} is not a number`);
    return value;
  });
  const read = item(values[3]!, values.slice(4, 11), values[2]!);
  return { ...read, autocontinue: values[11] !== 0 };
}
