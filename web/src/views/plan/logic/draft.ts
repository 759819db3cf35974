/** The plan as the browser keeps it, so that a page that is closed or reloaded loses no work. */

import { Tree, type Json } from '../formats/json';
import { apiItems, itemsIn, readMavstack, writeMavstack } from '../formats/mavstack';
import { EMPTY_PLAN, insertItems, keptItem, type Pattern, type Plan } from './model';
import { patternRuns } from './patterns';

/** Returns the text of a plan; empty for an empty plan. */
export function draftText(plan: Plan): string {
  if (plan === EMPTY_PLAN) return '';
  const kept = plan.mission.flatMap((each, index) => (each.kept ? [{ index, ...each.kept }] : []));
  const patterns = patternRuns(plan).map(({ pattern: { kind, json, items } }) => ({
    kind,
    json,
    items: apiItems(items),
  }));
  return JSON.stringify({ plan: JSON.parse(writeMavstack(plan)) as Json, kept, patterns });
}

/** Returns the plan of a text; an empty one if the text is of another version of the page. */
export function draftPlan(text: unknown): Plan {
  if (typeof text !== 'string' || text === '') return EMPTY_PLAN;
  try {
    const root = Tree.parse(text);
    const { plan } = readMavstack(root.need('plan'));
    const patterns = root
      .get('patterns')
      .list()
      .map((each): Pattern => {
        return {
          kind: each.get('kind').text(),
          json: each.need('json').value as Pattern['json'],
          items: itemsIn(each.get('items')),
        };
      });
    return root
      .get('kept')
      .list()
      .reduce<Plan>(
        (found, each) => {
          const kept = keptItem(each.get('kind').text(), each.need('json').value as Json);
          return insertItems(found, each.need('index').integer(0, found.mission.length), [kept]);
        },
        { ...plan, patterns },
      );
  } catch {
    return EMPTY_PLAN;
  }
}
