import { describe, expect, it } from 'vitest';

import { Decoder, Encoder, enumName, enumValues, messageInfo } from './Decoder';

describe('Decoder', () => {
  it('decodes what the encoder builds, cut anywhere', () => {
    const packet = new Encoder(7, 1).build('ATTITUDE', { time_boot_ms: 5, roll: 0.5 });
    const decoder = new Decoder();
    expect(decoder.push(packet.subarray(0, 9), 1)).toEqual([]);
    const [message] = decoder.push(packet.subarray(9), 2);
    expect(message).toMatchObject({ system: 7, component: 1, sequence: 0, time: 2, id: 30, name: 'ATTITUDE' });
    expect(message?.fields).toMatchObject({ time_boot_ms: 5, roll: 0.5, pitch: 0 });
  });

  it('gives 64-bit integers as numbers where they are exact', () => {
    const encoder = new Encoder();
    const times = [1_790_000_000_000_000, 2n ** 60n].map(
      (time_unix_usec) =>
        new Decoder().push(encoder.build('SYSTEM_TIME', { time_unix_usec }))[0]?.fields.time_unix_usec,
    );
    expect(times).toEqual([1_790_000_000_000_000, 2n ** 60n]);
  });
});

describe('Encoder', () => {
  it('refuses messages, fields and values that are not possible', () => {
    const encoder = new Encoder();
    expect(() => encoder.build('ATITUDE')).toThrow('no message is named ATITUDE');
    expect(() => encoder.build('ATTITUDE', { rol: 1 })).toThrow('ATTITUDE has no field rol');
    expect(() => encoder.build('HEARTBEAT', { type: 256 })).toThrow('type: 256 does not fit uint8_t');
  });

  it('sends the version of the dialect in heartbeats', () => {
    const [message] = new Decoder().push(new Encoder().build('HEARTBEAT', { type: 6 }));
    expect(message?.fields.mavlink_version).toBe(3);
  });
});

describe('names', () => {
  it('knows fields, units and enums', () => {
    expect(messageInfo('ATTITUDE')?.fields[1]).toMatchObject({ name: 'roll', units: 'rad' });
    expect(messageInfo('NOTHING')).toBeNull();
    expect(enumValues('MAV_CMD')?.NAV_TAKEOFF ?? enumValues('MAV_CMD')?.MAV_CMD_NAV_TAKEOFF).toBe(22);
    expect(enumName('MAV_TYPE', 2)).toBe('QUADROTOR');
    expect(enumName('GPS_FIX_TYPE', 3)).toBe('3D_FIX');
  });
});
