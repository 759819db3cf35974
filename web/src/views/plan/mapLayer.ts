/** The plan on the map: how it is painted, and what a pointer can take hold of. */

import { MavCmd, MavFrame } from '$generated';
import type { Projection } from '$lib/map/projection';
import type { FenceShape, MissionPath, Stop, StopKind } from '$lib/map/plan';
import { paintFence, paintHome, paintMission, paintRally } from '$lib/map/planLayer';
import { disc, polyline, type Drawing } from '$lib/map/drawing';

import type { Editor, Selection } from './editor.svelte';
import { itemPosition, isOnPath } from './logic/commands';
import { corridorOutline } from './logic/corridor';
import { between, type Point, radiusHandle } from './logic/geo';
import type { Item, Plan } from './logic/model';
import { pathOf } from './logic/path';

/** Something that can be dragged or chosen. */
export interface Handle {
  readonly at: Point;
  readonly target: Selection | { readonly kind: 'draft' };
  /** The corner of a polygon, or the point of the drawing. */
  readonly part: number;
  /** `middle`: a corner is inserted there; `radius`: the radius follows. */
  readonly role: 'place' | 'middle' | 'radius';
}

const HIT_RADIUS = 18;
const KINDS: Readonly<Record<number, StopKind>> = {
  [MavCmd.NAV_TAKEOFF]: 'takeoff',
  [MavCmd.NAV_VTOL_TAKEOFF]: 'takeoff',
  [MavCmd.NAV_LAND]: 'land',
  [MavCmd.NAV_VTOL_LAND]: 'land',
  [MavCmd.NAV_RETURN_TO_LAUNCH]: 'rtl',
  [MavCmd.NAV_SPLINE_WAYPOINT]: 'spline',
};
const RADIUS_PARAM: Readonly<Record<number, number>> = {
  [MavCmd.NAV_LOITER_UNLIM]: 2,
  [MavCmd.NAV_LOITER_TURNS]: 2,
  [MavCmd.NAV_LOITER_TIME]: 2,
  [MavCmd.NAV_LOITER_TO_ALT]: 1,
};

function stopOf(each: Item, index: number): Stop | null {
  const at = itemPosition(each);
  if (!at) return null;
  const radius = each.params[RADIUS_PARAM[each.command] ?? -1] ?? null;
  const kind = KINDS[each.command] ?? (isOnPath(each) ? 'waypoint' : 'interest');
  return { ...at, seq: index + 1, kind, altitude: each.params[6] ?? null, radius };
}

/** Returns the mission as the map paints it; stops are numbered from 1, as people count. */
export function missionPathOf(plan: Plan): MissionPath {
  const stops = plan.mission.map(stopOf).filter((each) => each !== null);
  const place = (index: number): Point | null =>
    plan.mission
      .slice(0, index + 1)
      .reverse()
      .map(itemPosition)
      .find((each) => each !== null) ?? null;
  const jumps = plan.mission.flatMap((each, index) => {
    const [from, to] = [place(index), place(each.params[0] ?? -1)];
    return each.command === MavCmd.DO_JUMP && from && to ? [[from, to] as const] : [];
  });
  // Once through the items, without the repetitions of jumps.
  const line = pathOf({
    ...plan,
    mission: plan.mission.map((each) => (each.command === MavCmd.DO_JUMP ? NO_JUMP : each)),
  });
  return { stops, line, jumps };
}

const NO_JUMP: Item = { command: 0, frame: MavFrame.MISSION, params: [], autocontinue: true };

export function shapesOf(plan: Plan): FenceShape[] {
  return [
    ...plan.polygons.map((each) => ({ kind: 'polygon' as const, isInclusion: each.inclusion, corners: each.vertices })),
    ...plan.circles.map((each) => ({
      kind: 'circle' as const,
      isInclusion: each.inclusion,
      centre: each.center,
      radius: each.radius,
    })),
    ...(plan.returnPoint ? [{ kind: 'return' as const, place: plan.returnPoint }] : []),
  ];
}

/** Returns what can be taken hold of, the topmost first. */
export function handlesOf(editor: Editor): Handle[] {
  const { plan, selection } = editor;
  const draft = editor.draft.map((at, part): Handle => ({ at, target: { kind: 'draft' }, part, role: 'place' }));
  const chosen = selection ? shapeHandles(plan, selection) : [];
  const items = plan.mission.flatMap((each, index): Handle[] => {
    const at = itemPosition(each);
    return at ? [{ at, target: { kind: 'item', index }, part: 0, role: 'place' }] : [];
  });
  const circles = plan.circles.map(
    ({ center }, index): Handle => ({ at: center, target: { kind: 'circle', index }, part: 0, role: 'place' }),
  );
  const rally = plan.rally.map(
    (at, index): Handle => ({ at, target: { kind: 'rally', index }, part: 0, role: 'place' }),
  );
  const polygons = plan.polygons.flatMap(({ vertices }, index) =>
    vertices.map((at, part): Handle => ({ at, target: { kind: 'polygon', index }, part, role: 'place' })),
  );
  const home = plan.home ? [{ at: plan.home, target: { kind: 'home' }, part: 0, role: 'place' } as const] : [];
  const back = plan.returnPoint
    ? [{ at: plan.returnPoint, target: { kind: 'return' }, part: 0, role: 'place' } as const]
    : [];
  return [...draft, ...chosen, ...items.reverse(), ...rally, ...circles, ...polygons, ...back, ...home];
}

/** The handles that only a selected shape has: the middles of its edges, its radius. */
function shapeHandles(plan: Plan, target: Selection): Handle[] {
  if (target.kind === 'circle') {
    const circle = plan.circles[target.index];
    return circle ? [{ at: radiusHandle(circle.center, circle.radius), target, part: 0, role: 'radius' }] : [];
  }
  if (target.kind !== 'polygon') return [];
  const vertices = plan.polygons[target.index]?.vertices ?? [];
  const corners = vertices.map((at, part): Handle => ({ at, target, part, role: 'place' }));
  const middles = vertices.map((from, index): Handle => {
    const at = between(from, vertices[(index + 1) % vertices.length]!);
    return { at, target, part: index + 1, role: 'middle' };
  });
  return [...corners, ...middles];
}

/** Returns the handle at a pixel; the nearest one counts. */
export function handleAt(handles: readonly Handle[], projection: Projection, x: number, y: number): Handle | null {
  let [nearest, best]: [number, Handle | null] = [HIT_RADIUS, null];
  for (const handle of handles) {
    const pixel = projection.toPixel(handle.at.latitude, handle.at.longitude);
    const away = Math.hypot(pixel.x - x, pixel.y - y);
    if (away < nearest) [nearest, best] = [away, handle];
  }
  return best;
}

/** Paints the plan with its selection and the drawing that is under way. */
export function paintPlan(drawing: Drawing, editor: Editor): void {
  const { plan } = editor;
  const selected = editor.selectedItem === null ? [] : [editor.selectedItem + 1];
  paintFence(drawing, shapesOf(plan));
  paintDraft(drawing, editor);
  paintMission(drawing, missionPathOf(plan), { selected, current: editor.currentItem });
  paintRally(drawing, plan.rally);
  if (plan.home) paintHome(drawing, plan.home);
  if (editor.selection) paintShapeHandles(drawing, shapeHandles(plan, editor.selection));
}

function paintShapeHandles(drawing: Drawing, handles: readonly Handle[]): void {
  const { projection, palette } = drawing;
  for (const { at, role } of handles) {
    const pixel = projection.toPixel(at.latitude, at.longitude);
    disc(drawing, pixel, role === 'middle' ? 4.5 : 7, {
      fill: role === 'middle' ? palette.halo : palette.accent,
      outline: palette.accent,
    });
  }
}

function paintDraft(drawing: Drawing, editor: Editor): void {
  const { projection, palette } = drawing;
  const pixels = (points: readonly Point[]) => points.map((each) => projection.toPixel(each.latitude, each.longitude));
  const { draft, tool } = editor;
  const style = { colour: palette.accent, width: 2, dash: [6, 4] };
  if (tool === 'corridor') {
    const outline = corridorOutline(draft, editor.pattern.value.width);
    polyline(drawing, pixels(outline), { ...style, isClosed: true, fill: `${palette.accent}22` });
    polyline(drawing, pixels(draft), { colour: palette.accent, width: 2 });
  } else polyline(drawing, pixels(draft), { ...style, isClosed: draft.length > 2, fill: `${palette.accent}22` });
  const lanes = editor.lanes.map(pixels);
  polyline(drawing, lanes.flat(), { colour: palette.mission, width: 1, dash: [2, 4] });
  for (const lane of lanes) polyline(drawing, lane, { colour: palette.mission, width: 2, hasHalo: lanes.length < 100 });
  for (const pixel of pixels(draft)) disc(drawing, pixel, 6.5, { fill: palette.accent, outline: palette.halo });
}
