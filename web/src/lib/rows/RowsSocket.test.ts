import { expect, it } from 'vitest';

import { readRow, StationClock } from './RowsSocket';

it('times of the station are turned into those of the browser', () => {
  for (const ahead of [0, 90_000, -90_000]) {
    const clock = new StationClock();
    // The second row is delayed on its way: the times between rows stay those of the station.
    const arrivals = [
      [1000, 1020],
      [1100, 1500],
      [1200, 1210],
      [1300, 1330],
    ] as const;
    const local = arrivals.map(([sent, arrived]) => clock.local(sent + ahead, arrived));
    expect(local).toEqual([1020, 1120, 1210, 1310]);
  }
});

it('what is no row is ignored', () => {
  expect(readRow('{"source": 1}')).toBeNull();
  expect(readRow('{"source": "a", "message": "ROW", "time": 2, "fields": {"b": 1}}')).toEqual({
    source: 'a',
    message: 'ROW',
    time: 2000,
    fields: { b: 1 },
  });
  const frame = '{"source": "a", "message": "FRAME", "time": 2, "fields": {"size": 2}, "data": "AQI="}';
  expect(readRow(frame)?.data).toEqual(Uint8Array.of(1, 2));
});
