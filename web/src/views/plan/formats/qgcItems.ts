/**
 * The items of a mission in QGroundControl's JSON, read by the rules of `mavstack.files.plans.qgc_items`
 * (`plan-cases.json` tests both).
 *
 * Surveys and corridor scans hold the items to fly, and those are read; their shape and settings are kept beside them,
 * and written again while the items are as they were. Landing patterns hold positions, from which
 * their items follow. A structure scan holds only a shape, from which QGroundControl computes items: it stays in the
 * plan as it is, so that a file that is saved again has it too, and the checks tell that no vehicle can take it.
 */

import { MavCmd, MavFrame } from '$generated';

import { item, keptItem, withParam, type Item, type Params, type Pattern, type Plan } from '../logic/model';
import { patternRuns } from '../logic/patterns';
import { PlanFileError, type Json, type Tree } from './json';

const LANDINGS: ReadonlySet<string> = new Set(['fwLandingPattern', 'vtolLandingPattern']);
/** The part of a survey or a corridor that holds its items. */
const STYLE = 'TransectStyleComplexItem';
const MAX_ID = 2 ** 31;

/** The items read so far, and the ids by which jumps name them. */
class Items {
  readonly items: Item[] = [];
  readonly patterns: Pattern[] = [];
  private readonly ids = new Map<number, number>();
  private readonly innerIds = new Map<number, number>();

  constructor(readonly notes: string[]) {}

  /** Adds an item; ids inside of a pattern count only where no other item has the same id. */
  add(each: Item, id: number | null = null, isInner = false): void {
    const ids = isInner ? this.innerIds : this.ids;
    if (id !== null && !ids.has(id)) ids.set(id, this.items.length);
    this.items.push(each);
  }

  /** Returns the items, with indexes in the list as the targets of jumps. */
  finished(): Item[] {
    return this.items.map((each, index) => this.resolved(each, index));
  }

  private resolved(each: Item, index: number): Item {
    const wanted = each.params[0];
    if (each.command !== MavCmd.DO_JUMP || wanted == null) return each;
    // Written by hand, without any ids.
    if (this.ids.size + this.innerIds.size === 0) return withParam(each, 1, wanted - 1);
    const target = this.ids.get(wanted) ?? this.innerIds.get(wanted);
    if (target === undefined) this.notes.push(`item ${index + 1} jumps to doJumpId ${wanted}, which no item has`);
    return withParam(each, 1, target ?? -1);
  }
}

/** Returns the items of a mission, with patterns resolved, and the patterns. */
export function readItems(mission: Tree, version: number, notes: string[]): Pick<Plan, 'mission' | 'patterns'> {
  const found = new Items(notes);
  for (const tree of mission.get('items').list()) {
    const kind = tree.get('type').exists ? tree.get('type').text() : 'SimpleItem';
    if (kind === 'SimpleItem' || kind === 'missionItem') found.add(simple(tree), jumpId(tree));
    else if (kind === 'ComplexItem') readPattern(tree, found);
    else throw tree.wrong(`has the unknown item type ${kind.slice(0, 40)}`);
  }
  if (version === 1) for (const tree of mission.get('complexItems').list()) keep(tree, 'survey', found);
  return { mission: found.finished(), patterns: found.patterns };
}

function simple(tree: Tree): Item {
  const params: Params = tree.get('params').exists
    ? tree
        .get('params')
        .list()
        .map((each) => each.numberOrNull())
    : [1, 2, 3, 4].map((number) => tree.need(`param${number}`).numberOrNull());
  const seven = params.length === 4 ? [...params, ...tree.need('coordinate').numbers(3)] : params;
  if (seven.length !== 7) throw tree.get('params').wrong(`has ${seven.length} numbers instead of 7`);
  const read = item(tree.need('command').integer(0, 0xffff), seven, tree.need('frame').integer(0, 0xff));
  return { ...read, autocontinue: tree.get('autoContinue').flag(true) };
}

function jumpId(tree: Tree): number | null {
  const found = tree.get('doJumpId').exists ? tree.get('doJumpId') : tree.get('id');
  const id = found.exists ? found.integer(-MAX_ID, MAX_ID) : -1;
  return id < 0 ? null : id;
}

function readPattern(tree: Tree, found: Items): void {
  const kind = tree.get('complexItemType').text().slice(0, 40) || 'pattern';
  const flown = tree.get(STYLE).get('Items');
  if (flown.exists) {
    const items = flown.list().map((inner) => {
      const each = simple(inner);
      found.add(each, jumpId(inner), true);
      return each;
    });
    found.patterns.push({ kind, json: withoutItems(tree.value as Pattern['json']), items });
  } else if (LANDINGS.has(kind)) {
    try {
      for (const each of landing(tree, kind, found.notes)) found.add(each);
    } catch (error) {
      if (!(error instanceof PlanFileError)) throw error;
      keep(tree, kind, found, `: ${error.message}`);
    }
  } else keep(tree, kind, found);
}

function withoutItems(json: Pattern['json']): Pattern['json'] {
  const { Items: _, ...style } = json[STYLE] as Readonly<Record<string, Json>>;
  return { ...json, [STYLE]: style };
}

/** Keeps a pattern that cannot be read as it is. */
function keep(tree: Tree, kind: string, found: Items, why = ', since the file holds no items of it'): void {
  found.notes.push(`${tree.path}: the ${kind} was not read${why}`);
  found.add(keptItem(kind, tree.value as Json));
}

/** Returns the items of a landing pattern. */
function landing(tree: Tree, kind: string, notes: string[]): Item[] {
  const approach = tree.get('landingApproachCoordinate').exists ? 'landingApproachCoordinate' : 'loiterCoordinate';
  const both = tree.get('altitudesAreRelative');
  const frame = (older: string): number =>
    (both.exists ? both : tree.need(older)).flag(false) ? MavFrame.GLOBAL_RELATIVE_ALT : MavFrame.GLOBAL;
  const isSet = (key: string, missing = false): boolean => tree.get(key).flag(missing);
  const stop = (command: number): Item => item(command, [0, null, null, null, null, null, null], MavFrame.MISSION);
  const items = [item(MavCmd.DO_LAND_START, [], MavFrame.MISSION)];
  if (isSet('stopTakingPhotos'))
    items.push(item(MavCmd.DO_SET_CAM_TRIGG_DIST, [], MavFrame.MISSION), stop(MavCmd.IMAGE_STOP_CAPTURE));
  if (isSet('stopVideoPhotos')) items.push(stop(MavCmd.VIDEO_STOP_CAPTURE));
  const place = tree.need(approach).finite(3);
  if (isSet('useLoiterToAlt', true)) {
    const radius = tree.need('loiterRadius').number() * (tree.need('loiterClockwise').flag(false) ? 1 : -1);
    items.push(item(MavCmd.NAV_LOITER_TO_ALT, [1, radius, 0, 1, ...place], frame('loiterAltitudeRelative')));
  } else items.push(item(MavCmd.NAV_WAYPOINT, [0, 0, 0, null, ...place], frame('loiterAltitudeRelative')));
  const land = tree.need('landCoordinate').finite(3);
  const isVtol = kind === 'vtolLandingPattern';
  items.push(
    item(
      isVtol ? MavCmd.NAV_VTOL_LAND : MavCmd.NAV_LAND,
      [0, 0, 0, isVtol ? null : 0, ...land],
      frame('landAltitudeRelative'),
    ),
  );
  if (isSet('useDoChangeSpeed')) notes.push(`${tree.path}: the approach speed was not read`);
  return items;
}

/** Returns the items as QGroundControl's file holds them, those of patterns in their patterns. */
export function itemsJson(plan: Pick<Plan, 'mission' | 'patterns'>): Json[] {
  const runs = patternRuns(plan);
  const simples = plan.mission.map(simpleJson);
  return simples.flatMap((each, index) => {
    const run = runs.find(({ start, end }) => index >= start && index < end);
    if (run === undefined) return [each];
    if (index > run.start) return [];
    const { json } = run.pattern;
    return [{ ...json, [STYLE]: { ...(json[STYLE] as object), Items: simples.slice(run.start, run.end) } }];
  });
}

function simpleJson(each: Item, index: number): Json {
  if (each.kept) return each.kept.json;
  const isJump = each.command === MavCmd.DO_JUMP && each.params[0] != null;
  return {
    autoContinue: each.autocontinue,
    command: each.command,
    doJumpId: index + 1,
    frame: each.frame,
    params: isJump ? withParam(each, 1, each.params[0]! + 1).params : each.params,
    type: 'SimpleItem',
  };
}
