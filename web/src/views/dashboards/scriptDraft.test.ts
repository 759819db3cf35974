import { expect, it } from 'vitest';
import { EXAMPLES } from './examples';
import { draftOf, readDraft } from './scriptDraft';

it('reads the scripts of the examples as they are', () => {
  for (const script of EXAMPLES.flatMap(({ dashboard }) => dashboard.scripts)) {
    expect(readDraft(draftOf(script))).toEqual({ script, problem: null });
  }
});

it.each([
  [{ name: 'no name', inputs: '', frames: '', code: 'return {}' }, 'letters'],
  [{ name: 'a', inputs: 'x = nonsense', frames: '', code: 'return {}' }, 'is not an input'],
  [{ name: 'a', inputs: '', frames: '1/1', code: 'return {}' }, 'name of a source'],
  [{ name: 'a', inputs: '', frames: '', code: '' }, 'empty'],
])('tells what is wrong with %j', (draft, problem) => {
  expect(readDraft(draft).problem).toContain(problem);
});
