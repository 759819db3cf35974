/** Files of what the page has seen: tables of values, and packets as a telemetry log. */
import { formatFieldRef } from './fieldRef';
import type { TimedPacket } from './PacketHistory';
import type { Series } from './SeriesHub';

/** Returns a CSV file of series: a column of times in seconds since 1970, one column for each series. */
export function csvOf(series: readonly Series[]): string {
  const header = ['time_s', ...series.map(({ ref }) => quoted(formatFieldRef(ref)))];
  const times = new Map<number, (number | undefined)[]>();
  series.forEach(({ ring }, column) => {
    for (let index = 0; index < ring.length; index++) {
      const time = ring.timeAt(index);
      let row = times.get(time);
      if (row === undefined) times.set(time, (row = new Array<number | undefined>(series.length).fill(undefined)));
      row[column] = ring.valueAt(index);
    }
  });
  const rows = [...times]
    .sort(([a], [b]) => a - b)
    .map(([time, row]) => [time / 1000, ...row.map((value) => value ?? '')]);
  return [header, ...rows].map((row) => `${row.join(',')}\n`).join('');
}

/** Returns a text as a cell that no spreadsheet runs as a formula: the names of series come from their senders. */
function quoted(text: string): string {
  if (/^[=@\t\r＝＠＋－+-]/.test(text) && !/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text)) text = `'${text}`;
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** Returns a tlog: each packet after its time, in µs since 1970 as a big-endian integer of 64 bits. */
export function tlogOf(packets: readonly TimedPacket[]): Uint8Array<ArrayBuffer> {
  const log = new Uint8Array(packets.reduce((size, { bytes }) => size + 8 + bytes.length, 0));
  const view = new DataView(log.buffer);
  let at = 0;
  for (const { time, bytes } of packets) {
    view.setBigUint64(at, BigInt(Math.round(time * 1000)));
    log.set(bytes, at + 8);
    at += 8 + bytes.length;
  }
  return log;
}

/** Returns a name with the date and the time, such as `trends-20261123-101500.csv`. */
export function datedName(word: string, suffix: string, date = new Date()): string {
  const [day, time] = date.toISOString().slice(0, 19).replaceAll(/[-:]/g, '').split('T');
  return `${word}-${day}-${time}.${suffix}`;
}
