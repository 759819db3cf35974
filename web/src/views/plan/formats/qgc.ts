/** QGroundControl's `.plan` files. */

import { EMPTY_PLAN, type Circle, type Place, type Plan, type Polygon } from '../logic/model';
import type { Point } from '../logic/geo';
import { Tree } from './json';
import { itemsJson, readItems } from './qgcItems';

export interface ReadPlan {
  readonly plan: Plan;
  /** Parts of the file that could not be read. */
  readonly notes: readonly string[];
}

/** Returns the text of a `.plan`. */
export function writeQgc(plan: Plan): string {
  const home = plan.home ?? firstPlace(plan);
  const triple = (at: Place): number[] => [at.latitude, at.longitude, at.altitude];
  const pair = (at: Point): number[] => [at.latitude, at.longitude];
  const whole = {
    fileType: 'Plan',
    geoFence: {
      ...(plan.returnPoint ? { breachReturn: triple(plan.returnPoint) } : {}),
      circles: plan.circles.map((each) => ({
        circle: { center: pair(each.center), radius: each.radius },
        inclusion: each.inclusion,
        version: 1,
      })),
      polygons: plan.polygons.map((each) => ({
        inclusion: each.inclusion,
        polygon: each.vertices.map(pair),
        version: 1,
      })),
      version: 2,
    },
    groundStation: 'Mavstack',
    mission: {
      cruiseSpeed: plan.cruiseSpeed,
      firmwareType: plan.firmware,
      globalPlanAltitudeMode: 0,
      hoverSpeed: plan.hoverSpeed,
      items: itemsJson(plan),
      plannedHomePosition: triple(home),
      vehicleType: plan.vehicleType,
      version: 2,
    },
    rallyPoints: { points: plan.rally.map(triple), version: 2 },
    version: 1,
  };
  return `${JSON.stringify(whole, null, 4)}\n`;
}

function firstPlace(plan: Plan): Place {
  const first = plan.mission.find((each) => each.params[4] && each.params[5]);
  return { latitude: first?.params[4] ?? 0, longitude: first?.params[5] ?? 0, altitude: 0 };
}

/** Reads a `.plan`, or a file of an older version; throws `PlanFileError` with the place of what is wrong. */
export function readQgc(root: Tree): ReadPlan {
  const notes: string[] = [];
  const [mission, fence, rally] = partsOf(root);
  const version = versionOf(mission);
  versionOf(rally);
  const firmware = mission.get('firmwareType').exists ? mission.get('firmwareType') : mission.get('MAV_AUTOPILOT');
  const plan: Plan = {
    ...EMPTY_PLAN,
    home: readHome(mission.get('plannedHomePosition')),
    ...(mission.exists ? readItems(mission, version, notes) : { mission: [], patterns: [] }),
    ...readFence(fence, notes),
    rally: rally.get('points').list().map(readPlace),
    cruiseSpeed: mission.get('cruiseSpeed').numberOr(EMPTY_PLAN.cruiseSpeed),
    hoverSpeed: mission.get('hoverSpeed').numberOr(EMPTY_PLAN.hoverSpeed),
    firmware: firmware.exists ? firmware.integer(0, 255) : EMPTY_PLAN.firmware,
    vehicleType: mission.get('vehicleType').exists
      ? mission.get('vehicleType').integer(0, 255)
      : EMPTY_PLAN.vehicleType,
  };
  return { plan, notes };
}

/** Returns mission, fence and rally points: parts of a plan, or the whole of an older file. */
function partsOf(root: Tree): [Tree, Tree, Tree] {
  const none = new Tree(undefined);
  const kind = root.get('fileType').text().toLowerCase();
  if (kind === 'mission') return [root, none, none];
  if (kind === 'geofence') return [none, root, none];
  if (kind === 'rallypoints') return [none, none, root];
  const parts: [Tree, Tree, Tree] = [root.get('mission'), root.get('geoFence'), root.get('rallyPoints')];
  if (parts.some((each) => each.exists)) {
    versionOf(root, 1);
    return parts;
  }
  if (root.get('items').exists) return [root, none, none];
  throw root.wrong('has none of mission, geoFence and rallyPoints, so it is not a plan');
}

/** Returns the version of a part; older files hold version 1 as a text, or leave it out. */
function versionOf(tree: Tree, newest = 2): number {
  const found = tree.get('version');
  if (!found.exists || found.value === '1.0' || found.value === '1') return 1;
  const version = found.number();
  if (version !== 1 && version !== newest) throw found.wrong(`version ${version} is not supported`);
  return version;
}

function readPlace(tree: Tree): Place {
  const [latitude, longitude, altitude] = tree.list().map((each) => each.numberOr(null));
  if (latitude == null || longitude == null) throw tree.wrong('is not a latitude and a longitude');
  return { latitude, longitude, altitude: altitude ?? 0 };
}

function readPoint(tree: Tree): Point {
  const { latitude, longitude } = readPlace(tree);
  return { latitude, longitude };
}

function readHome(tree: Tree): Place | null {
  if (!tree.exists) return null;
  const home = readPlace(Array.isArray(tree.value) ? tree : tree.need('coordinate'));
  return home.latitude === 0 && home.longitude === 0 ? null : home;
}

function readFence(tree: Tree, notes: string[]): Pick<Plan, 'polygons' | 'circles' | 'returnPoint'> {
  const old = versionOf(tree) === 1 ? tree.get('polygon').list().map(readPoint) : [];
  if (old.length > 0 && old.length < 3) throw tree.wrong(`a polygon needs at least 3 vertices, got ${old.length}`);
  const first: Polygon[] = old.length ? [{ inclusion: true, vertices: old }] : [];
  const polygons = tree
    .get('polygons')
    .list()
    .map((each): Polygon => {
      const vertices = each.get('polygon').list().map(readPoint);
      if (vertices.length < 3) throw each.wrong(`a polygon needs at least 3 vertices, got ${vertices.length}`);
      for (const key of ['minAltitude', 'maxAltitude', 'altitudeMin', 'altitudeMax']) {
        if (each.get(key).exists) notes.push(`${each.get(key).path}: altitude limits of a polygon are not supported`);
      }
      return { inclusion: each.get('inclusion').flag(true), vertices };
    });
  const circles = tree
    .get('circles')
    .list()
    .map((each): Circle => {
      const circle = each.get('circle');
      const radius = circle.get('radius').number();
      return { inclusion: each.get('inclusion').flag(true), center: readPoint(circle.get('center')), radius };
    });
  if (!tree.get('version').exists && first.length + polygons.length + circles.length > 0) {
    notes.push(`${tree.path}: has no version; QGroundControl ignores such a fence`);
  }
  const breach = tree.get('breachReturn');
  return { polygons: [...first, ...polygons], circles, returnPoint: breach.list().length ? readPlace(breach) : null };
}
