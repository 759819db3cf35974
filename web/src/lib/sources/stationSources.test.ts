import { expect, it } from 'vitest';
import { missingSources } from './stationSources';

it('finds the sources that the station does not have', () => {
  const sources = [{ url: 'tcpout://127.0.0.1:5760' }, { url: 'csv+tcp://127.0.0.1:5781?name=a&template=b' }];
  const needed = ['tcpout://127.0.0.1:5760', 'tcpout://127.0.0.1:5770', 'csv+tcp://127.0.0.1:5781?template=b&name=a'];
  expect(missingSources(needed, sources)).toEqual(['tcpout://127.0.0.1:5770']);
});
