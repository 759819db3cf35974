/** QGroundControl's `.plan` files. */

import { CMD, EMPTY_PLAN, FRAME, item, withParam, type Circle, type Item, type Place, type Plan, type Polygon } from '../logic/model';
import type { Point } from '../logic/geo';
import { Tree } from './json';

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
      items: plan.mission.map((each, index) => ({
        autoContinue: each.autocontinue,
        command: each.command,
        doJumpId: index + 1,
        frame: each.frame,
        params: each.command === CMD.DO_JUMP ? withParam(each, 1, (each.params[0] ?? 0) + 1).params : each.params,
        type: 'SimpleItem',
      })),
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

/** Reads a `.plan`; throws `PlanFileError` with the place of what is wrong. */
export function readQgc(root: Tree): ReadPlan {
  const notes: string[] = [];
  const mission = root.get('mission');
  if (!mission.exists && !root.get('geoFence').exists && !root.get('rallyPoints').exists) {
    throw root.wrong('has none of mission, geoFence and rallyPoints, so it is not a plan');
  }
  const plan: Plan = {
    ...EMPTY_PLAN,
    home: readHome(mission.get('plannedHomePosition')),
    mission: readItems(mission.get('items'), notes),
    ...readFence(root.get('geoFence'), notes),
    rally: root.get('rallyPoints').get('points').list().map(readPlace),
    cruiseSpeed: mission.get('cruiseSpeed').numberOr(EMPTY_PLAN.cruiseSpeed),
    hoverSpeed: mission.get('hoverSpeed').numberOr(EMPTY_PLAN.hoverSpeed),
    firmware: mission.get('firmwareType').numberOr(EMPTY_PLAN.firmware),
    vehicleType: mission.get('vehicleType').numberOr(EMPTY_PLAN.vehicleType),
  };
  return { plan, notes };
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
  const home = readPlace(tree);
  return home.latitude === 0 && home.longitude === 0 ? null : home;
}

function readFence(tree: Tree, notes: string[]): Pick<Plan, 'polygons' | 'circles' | 'returnPoint'> {
  const polygons = tree.get('polygons').list().map((each): Polygon => {
    const vertices = each.get('polygon').list().map(readPoint);
    if (vertices.length < 3) throw each.wrong(`a polygon needs at least 3 vertices, got ${vertices.length}`);
    for (const key of ['minAltitude', 'maxAltitude', 'altitudeMin', 'altitudeMax']) {
      if (each.get(key).exists) notes.push(`${each.get(key).path}: altitude limits of a polygon are not supported`);
    }
    return { inclusion: each.get('inclusion').flag(true), vertices };
  });
  const circles = tree.get('circles').list().map((each): Circle => {
    const circle = each.get('circle');
    const radius = circle.get('radius').number();
    return { inclusion: each.get('inclusion').flag(true), center: readPoint(circle.get('center')), radius };
  });
  const breach = tree.get('breachReturn');
  return { polygons, circles, returnPoint: breach.list().length ? readPlace(breach) : null };
}

/** Reads items; those of patterns are the ones that QGroundControl has stored with them. */
function readItems(tree: Tree, notes: string[]): Item[] {
  const ids = new Map<number, number>();
  const items: Item[] = [];
  const add = (each: Tree): void => {
    ids.set(each.get('doJumpId').numberOr(items.length + 1), items.length);
    items.push(readItem(each));
  };
  for (const each of tree.list()) {
    if (each.get('type').text() !== 'ComplexItem') add(each);
    else {
      const inner = each.get('TransectStyleComplexItem').get('Items').list();
      inner.forEach(add);
      const kind = each.get('complexItemType').text() || 'pattern';
      if (!inner.length) notes.push(`${each.path}: the ${kind} was not read, since the file holds no items of it`);
    }
  }
  return items.map((each) =>
    each.command === CMD.DO_JUMP ? withParam(each, 1, ids.get(each.params[0] ?? -1) ?? -1) : each,
  );
}

function readItem(tree: Tree): Item {
  const params = tree.get('params').list().map((each) => each.numberOr(null));
  if (params.length === 4) params.push(...tree.get('coordinate').numbers(3));
  if (params.length !== 7) throw tree.get('params').wrong(`has ${params.length} numbers instead of 7`);
  const read = item(tree.get('command').number(), params, tree.get('frame').numberOr(FRAME.MISSION));
  return { ...read, autocontinue: tree.get('autoContinue').flag(true) };
}
