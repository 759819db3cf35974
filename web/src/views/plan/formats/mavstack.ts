/** The JSON of the server's API and of `mav mission show --json`, which holds every plan without loss. */

import { fenceAreas, fenceItems, rallyItems, rallyPoints } from '../logic/fence';
import { EMPTY_PLAN, item, withoutKept, type Item, type Plan } from '../logic/model';
import { commandInfo } from '../logic/commands';
import type { Tree } from './json';
import type { ReadPlan } from './qgc';

/** An item as the API and `Vehicle.uploadPlan` take it. */
export interface ApiItem {
  readonly seq: number;
  readonly command: number;
  readonly name: string;
  readonly frame: number;
  readonly params: readonly (number | null)[];
  readonly autocontinue: boolean;
}

export function apiItems(items: readonly Item[]): ApiItem[] {
  return items.map(({ command, frame, params, autocontinue }, seq) => ({
    seq,
    name: commandInfo(command).name,
    command,
    frame,
    params,
    autocontinue,
  }));
}

/** Returns items that were downloaded; frames with `_INT` become those without. */
export function fromApi(items: readonly Omit<ApiItem, 'seq' | 'name'>[]): Item[] {
  return items.map((each) => ({ ...item(each.command, each.params, each.frame), autocontinue: each.autocontinue }));
}

export function writeMavstack(whole: Plan): string {
  const plan = withoutKept(whole);
  const file = {
    fileType: 'MavstackPlan',
    version: 1,
    home: plan.home,
    vehicle: {
      firmware: plan.firmware,
      vehicle_type: plan.vehicleType,
      cruise_speed: plan.cruiseSpeed,
      hover_speed: plan.hoverSpeed,
    },
    mission: apiItems(plan.mission),
    fence: apiItems(fenceItems(plan)),
    rally: apiItems(rallyItems(plan.rally)),
  };
  return `${JSON.stringify(file, null, 2)}\n`;
}

/** Returns the items of a list in a file. */
export function itemsIn(tree: Tree): Item[] {
  return tree.list().map((each) => {
    const read = item(
      each.need('command').integer(0, 0xffff),
      each.need('params').numbers(7),
      each.need('frame').integer(0, 0xff),
    );
    return { ...read, autocontinue: each.get('autocontinue').flag(true) };
  });
}

export function readMavstack(root: Tree): ReadPlan {
  const items = (key: string): Item[] => itemsIn(root.get(key));
  const { problems, ...areas } = fenceAreas(items('fence'));
  const [home, vehicle] = [root.get('home'), root.get('vehicle')];
  const plan: Plan = {
    ...EMPTY_PLAN,
    home: home.exists
      ? {
          latitude: home.get('latitude').number(),
          longitude: home.get('longitude').number(),
          altitude: home.get('altitude').numberOr(0),
        }
      : null,
    mission: items('mission'),
    ...areas,
    rally: rallyPoints(items('rally')),
    firmware: vehicle.get('firmware').numberOr(EMPTY_PLAN.firmware),
    vehicleType: vehicle.get('vehicle_type').numberOr(EMPTY_PLAN.vehicleType),
    cruiseSpeed: vehicle.get('cruise_speed').numberOr(EMPTY_PLAN.cruiseSpeed),
    hoverSpeed: vehicle.get('hover_speed').numberOr(EMPTY_PLAN.hoverSpeed),
  };
  return { plan, notes: problems };
}
