import { describe, expect, it } from 'vitest';

import { fenceItems, rallyItems } from '../logic/fence';
import { withoutKept, type Item } from '../logic/model';
import { PlanFileError, readPlan } from '.';
import cases from './plan-cases.json';

const rows = (items: readonly Item[]) =>
  items.map(({ command, frame, params, autocontinue }) => [command, frame, params, autocontinue]);

/** `tests/files/plans/test_plan_cases.py` reads the files by Python: both must find the same plans. */
describe('files that Python reads too', () => {
  it.each(cases.map((each) => [each.name, each] as const))('%s', (_, each) => {
    if ('refused' in each) {
      expect(() => readPlan(each.file)).toThrow(PlanFileError);
      return;
    }
    const read = readPlan(each.file);
    const plan = withoutKept(read.plan);
    expect(rows(plan.mission)).toEqual(each.mission);
    expect(rows(fenceItems(plan))).toEqual(each.fence);
    expect(rows(rallyItems(plan.rally))).toEqual(each.rally);
    expect(plan.home).toEqual(each.home);
    expect(read.notes.length > 0).toBe(each.problems! > 0);
  });
});
