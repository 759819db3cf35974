import { expect, it } from 'vitest';
import { PacketHistory } from './PacketHistory';
import { SeriesHub } from './SeriesHub';
import { csvOf, datedName, tlogOf } from './export';
import { parseFieldRef } from './fieldRef';

it('writes one row for each time', () => {
  const hub = new SeriesHub();
  const [a, b] = ['1/1:A.x', 'c,s:ROW.y'].map((text) => hub.watch(parseFieldRef(text)!));
  hub.feed({ source: '1/1', message: 'A', time: 1000, fields: { x: 1 } });
  hub.feed({ source: 'c,s', message: 'ROW', time: 500, fields: { y: 2.5 } });
  hub.feed({ source: '1/1', message: 'A', time: 1500, fields: { x: 3 } });
  expect(csvOf([a!, b!])).toBe('time_s,1/1:A.x,"c,s:ROW.y"\n0.5,,2.5\n1,1,\n1.5,3,\n');
});

it('writes names of series as texts, not as formulas', () => {
  const hub = new SeriesHub();
  const watched = ['=cmd|x:A.y', '-1+1:A.y', '@SUM:A.y'].map((text) => hub.watch(parseFieldRef(text)!));
  expect(csvOf(watched.map((each) => each!))).toBe("time_s,'=cmd|x:A.y,'-1+1:A.y,'@SUM:A.y\n");
});

it('writes a tlog with times in microseconds', () => {
  const log = tlogOf([{ time: 1.5, bytes: new Uint8Array([0xfd, 7]) }]);
  expect([...log]).toEqual([0, 0, 0, 0, 0, 0, 5, 220, 0xfd, 7]);
});

it('keeps the newest packets', () => {
  const history = new PacketHistory(100);
  for (let index = 0; index < 10_000; index++) history.add(index, new Uint8Array(20));
  expect(history.length).toBe(5);
  expect(history.list()[0]!.time).toBe(9995);
  history.clear();
  expect(history.length).toBe(0);
});

it('names files by the time', () => {
  expect(datedName('trends', 'csv', new Date(0))).toBe('trends-19700101-000000.csv');
});
