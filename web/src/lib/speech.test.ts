import { expect, it } from 'vitest';

import { REPEAT_AFTER, Announcer } from './speech';

it('speaks each alert once, and again when it comes back later', () => {
  const heard: string[] = [];
  const announcer = new Announcer({ speak: (text) => heard.push(text), stop: () => heard.push('-') });
  announcer.announce(['Battery low'], 0);
  announcer.announce(['Battery low', 'Fence'], 1000);
  expect(heard).toEqual(['Battery low', 'Fence']);
  // It flickers: nothing is spoken again.
  announcer.announce(['Fence'], 2000);
  announcer.announce(['Battery low', 'Fence'], 3000);
  expect(heard).toHaveLength(2);
  announcer.announce([], 4000);
  announcer.announce([], 4001 + REPEAT_AFTER);
  announcer.announce(['Fence'], 5000 + REPEAT_AFTER);
  expect(heard).toEqual(['Battery low', 'Fence', 'Fence']);
  announcer.stop();
  announcer.announce(['Fence'], 6000 + REPEAT_AFTER);
  expect(heard.slice(3)).toEqual(['-', 'Fence']);
});
