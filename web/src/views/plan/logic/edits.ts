/** Edits of whatever is selected: an item, an area, a point. */

import type { Point } from './geo';
import { changedAt, moveVertex, placedAt, removeItems, replaceItem, without, type Plan } from './model';

export type Selection =
  | { readonly kind: 'item' | 'polygon' | 'circle' | 'rally'; readonly index: number }
  | { readonly kind: 'home' | 'return' };

/** Returns whether a plan has what is selected: an undo or a download may have taken it away. */
export function has(plan: Plan, target: Selection): boolean {
  if (target.kind === 'home') return plan.home !== null;
  if (target.kind === 'return') return plan.returnPoint !== null;
  const { kind, index } = target as Extract<Selection, { index: number }>;
  return index < { item: plan.mission, polygon: plan.polygons, circle: plan.circles, rally: plan.rally }[kind].length;
}

/** Moves what is selected; `handle` is the corner of a polygon. A plan that does not have it stays. */
export function moved(plan: Plan, target: Selection, to: Point, handle = 0): Plan {
  if (!has(plan, target)) return plan;
  const [index, point] = ['index' in target ? target.index : 0, { latitude: to.latitude, longitude: to.longitude }];
  const edits: Record<Selection['kind'], () => Plan> = {
    item: () => replaceItem(plan, index, placedAt(plan.mission[index]!, point)),
    polygon: () => moveVertex(plan, index, handle, point),
    circle: () => ({ ...plan, circles: changedAt(plan.circles, index, { ...plan.circles[index]!, center: point }) }),
    rally: () => ({ ...plan, rally: changedAt(plan.rally, index, { ...plan.rally[index]!, ...point }) }),
    home: () => ({ ...plan, home: { altitude: 0, ...plan.home, ...point } }),
    return: () => ({ ...plan, returnPoint: { altitude: 0, ...plan.returnPoint, ...point } }),
  };
  return edits[target.kind]();
}

/** Removes what is selected. */
export function removed(plan: Plan, target: Selection): Plan {
  const index = 'index' in target ? target.index : 0;
  const edits: Record<Selection['kind'], () => Plan> = {
    item: () => removeItems(plan, new Set([index])),
    polygon: () => ({ ...plan, polygons: without(plan.polygons, index) }),
    circle: () => ({ ...plan, circles: without(plan.circles, index) }),
    rally: () => ({ ...plan, rally: without(plan.rally, index) }),
    home: () => ({ ...plan, home: null }),
    return: () => ({ ...plan, returnPoint: null }),
  };
  return edits[target.kind]();
}
