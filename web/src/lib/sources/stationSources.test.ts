import { expect, it } from 'vitest';
import { missingSources, sourceRequest } from './stationSources';

it('finds the sources that the station does not have', () => {
  const sources = [{ url: 'tcpout://127.0.0.1:5760' }, { url: 'csv+tcp://127.0.0.1:5781?name=a&template=b' }];
  const needed = ['tcpout://127.0.0.1:5760', 'tcpout://127.0.0.1:5770', 'csv+tcp://127.0.0.1:5781?template=b&name=a'];
  expect(missingSources(needed, sources)).toEqual(['tcpout://127.0.0.1:5770']);
});

it('sends the decoder that a source names', () => {
  const decoders = [{ name: 'bench', declaration: { framing: { kind: 'cobs' } } }];
  const url = 'frames+udp://0.0.0.0:9000?name=a&decoder=bench';
  expect(sourceRequest(url, decoders)).toEqual({ url, decoder: decoders[0]!.declaration });
  expect(sourceRequest(url, [])).toEqual({ url });
  expect(sourceRequest('csv+udp://0.0.0.0:9000?decoder=bench', decoders)).not.toHaveProperty('decoder');
});
