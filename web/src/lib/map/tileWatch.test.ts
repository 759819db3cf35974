import { expect, it, vi } from 'vitest';

import { NO_BASE } from './base';
import { TileWatch } from './tileWatch';

const TILES = { url: 'https://tiles/{z}/{x}/{y}.png', attribution: '' };

function watched(): { watch: TileWatch; fire: (name: string, event: object) => void; failed: () => void } {
  const listeners = new Map<string, (event: object) => void>();
  const map = { on: (name: string, listener: (event: object) => void) => void listeners.set(name, listener) };
  const failed = vi.fn();
  const watch = new TileWatch(map as unknown as ConstructorParameters<typeof TileWatch>[0], failed);
  return { watch, failed, fire: (name, event) => listeners.get(name)?.(event) };
}

it('tells once that no tile can be read, and again for another address', () => {
  const { watch, fire, failed } = watched();
  watch.restart(TILES);
  for (let count = 0; count < 3; count += 1) fire('error', { sourceId: 'base' });
  expect(failed).toHaveBeenCalledTimes(1);
  watch.restart(TILES);
  fire('error', { sourceId: 'base' });
  expect(failed).toHaveBeenCalledTimes(2);
});

it('tells nothing of other sources, of a map without tiles, or once a tile came', () => {
  const { watch, fire, failed } = watched();
  watch.restart(TILES);
  fire('error', { sourceId: 'tracks' });
  fire('error', { error: new Error('style') });
  fire('sourcedata', { sourceId: 'base', tile: {} });
  fire('error', { sourceId: 'base' });
  watch.restart(NO_BASE);
  fire('error', { sourceId: 'base' });
  expect(failed).not.toHaveBeenCalled();
});
