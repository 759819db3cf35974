import { expect, it } from 'vitest';

import { route } from './route.svelte';

it.each([
  ['#/plan/mission', 'plan', 'mission'],
  ['#/logs/a%20b/c', 'logs', 'a b/c'],
  ['#/plan/%E0%A4%A', 'plan', '%E0%A4%A'],
  ['', '', ''],
])('reads %s', (hash, view, rest) => {
  route.read(hash);
  expect([route.view, route.rest]).toEqual([view, rest]);
});
