import { expect, it } from 'vitest';

import { REPEAT_AFTER, Speaker } from './speech';

it('speaks each alert once, and again when it comes back later', () => {
  const said: string[] = [];
  const speaker = new Speaker({ speak: (text) => said.push(text), stop: () => said.push('-') });
  speaker.announce(['Battery low'], 0);
  speaker.announce(['Battery low', 'Fence'], 1000);
  expect(said).toEqual(['Battery low', 'Fence']);
  // It flickers: nothing is said again.
  speaker.announce(['Fence'], 2000);
  speaker.announce(['Battery low', 'Fence'], 3000);
  expect(said).toHaveLength(2);
  speaker.announce([], 4000);
  speaker.announce([], 4001 + REPEAT_AFTER);
  speaker.announce(['Fence'], 5000 + REPEAT_AFTER);
  expect(said).toEqual(['Battery low', 'Fence', 'Fence']);
  speaker.stop();
  speaker.announce(['Fence'], 6000 + REPEAT_AFTER);
  expect(said.slice(3)).toEqual(['-', 'Fence']);
});
