import { MavCmd } from '$generated';

import { describe, expect, it } from 'vitest';

import { fenceAreas, fenceItems } from './fence';
import { begin, commit, redo, undo } from './history';
import { EMPTY_PLAN, insertItems, item, moveItem, moveVertex, removeItems, waypoint, type Plan } from './model';

const at = (latitude: number) => waypoint({ latitude, longitude: 8 }, 30);
const jump = (target: number) => item(MavCmd.DO_JUMP, [target, 2]);
const plan: Plan = { ...EMPTY_PLAN, mission: [at(1), at(2), at(3), jump(1)] };
const target = (edited: Plan) => edited.mission.find((each) => each.command === MavCmd.DO_JUMP)?.params[0];

describe('edits of a mission', () => {
  it('moves the targets of jumps with the items that they name', () => {
    expect(target(insertItems(plan, 0, [at(0)]))).toBe(2);
    expect(target(insertItems(plan, 2, [at(0)]))).toBe(1);
    expect(target(removeItems(plan, new Set([0])))).toBe(0);
    expect(target(removeItems(plan, new Set([1])))).toBe(-1);
    expect(target(moveItem(plan, 1, 0))).toBe(0);
    expect(target(moveItem(plan, 0, 3))).toBe(0);
  });

  it('keeps the order of the others when an item moves', () => {
    const order = moveItem(plan, 2, 0).mission.map((each) => each.params[4]);
    expect(order.slice(0, 3)).toEqual([3, 1, 2]);
  });

  it('removes a polygon that has less than three corners', () => {
    const vertices = [1, 2, 3].map((latitude) => ({ latitude, longitude: latitude ** 2 }));
    const fenced = { ...EMPTY_PLAN, polygons: [{ inclusion: true, vertices }] };
    expect(moveVertex(fenced, 0, 1, { latitude: 9, longitude: 9 }).polygons[0]?.vertices[1]?.latitude).toBe(9);
    expect(moveVertex(fenced, 0, 1, null).polygons).toEqual([]);
  });
});

describe('fence items', () => {
  it('are the areas again', () => {
    const vertices = [1, 2, 3, 4].map((latitude) => ({ latitude, longitude: latitude ** 2 }));
    const areas = {
      polygons: [
        { inclusion: true, vertices },
        { inclusion: false, vertices: vertices.slice(1) },
      ],
      circles: [{ inclusion: false, center: { latitude: 5, longitude: 6 }, radius: 70 }],
      returnPoint: { latitude: 1, longitude: 1, altitude: 25 },
    };
    expect(fenceAreas(fenceItems(areas))).toEqual({ ...areas, problems: [] });
  });

  it('that are no polygon are told', () => {
    const items = fenceItems({
      polygons: [{ inclusion: true, vertices: [1, 2, 3].map((each) => ({ latitude: each, longitude: 0 })) }],
      circles: [],
      returnPoint: null,
    });
    expect(fenceAreas(items.slice(1)).problems).toEqual(['fence item 0: 2 vertices, but param 1 says 3']);
  });
});

describe('history', () => {
  it('undoes and redoes, and takes edits of one gesture together', () => {
    let history = commit(begin(1), 2);
    history = commit(commit(history, 3, 'drag'), 4, 'drag');
    expect(undo(history).present).toBe(2);
    expect(redo(undo(undo(history))).present).toBe(2);
    expect(undo(undo(undo(history))).present).toBe(1);
    expect(redo(commit(undo(history), 9)).present).toBe(9);
  });
});
