import { describe, expect, it } from 'vitest';

import { FACTS, messageFacts } from '$lib/msp/facts';

import {
  activeModes,
  armingReasons,
  channelName,
  formFields,
  functionsOf,
  osdBits,
  osdPosition,
  vtxRequest,
} from './logic';

describe('facts of flight controllers', () => {
  it('name modes by their position, also beyond the first 32', () => {
    const ids = Array.from({ length: 40 }, (_, index) => (index === 1 ? 1 : index === 33 ? 46 : 0));
    const status = { mode_flags: 2, extra_mode_flags: [2] };
    expect(activeModes(status, ids, 'BTFL')).toEqual(['ANGLE', 'GPS RESCUE']);
    expect(activeModes({ mode_words: [2, 0] }, [0, 10], 'INAV')).toEqual(['NAV RTH']);
  });

  it('name the reasons not to arm; the last one of Betaflight is the switch', () => {
    expect(armingReasons({ arming_disable_flags: 2 ** 7 + 2 ** 28, arming_disable_flag_count: 29 }, 'BTFL')).toEqual([
      'THROTTLE',
      'ARM_SWITCH',
    ]);
    expect(armingReasons({ arming_flags: 4 + 2 ** 19 }, 'INAV')).toEqual(['THROTTLE']);
  });

  it('name functions, rates and ports by the numbers of the firmware', () => {
    const ports = messageFacts('SerialConfig').fields[0]!.codec;
    const [betaflight, inav] = [new Map(functionsOf(ports, 'BTFL')), new Map(functionsOf(ports, 'INAV'))];
    expect([betaflight.get(2 ** 9), inav.get(2 ** 9)]).toEqual(['TELEMETRY_MAVLINK', 'TELEMETRY_IBUS']);
    expect([FACTS.baudRates.BTFL[5], FACTS.baudRates.INAV[5]]).toEqual([115_200, 19_200]);
    expect([0, 20, 31, 40, 52].map((port) => FACTS.portNames[port])).toEqual([
      'UART1',
      'VCP',
      'SOFTSERIAL2',
      'LPUART1',
      'UART2',
    ]);
  });

  it('move items of the display, and keep their other profiles', () => {
    const before = 5 | (3 << 5) | (4 << 11) | (1 << 14);
    expect(osdPosition(before, 'BTFL')).toEqual({ column: 5, row: 3, isShown: true });
    const moved = osdBits({ column: 40, row: 9, isShown: true }, before, 'BTFL');
    expect(osdPosition(moved, 'BTFL')).toEqual({ column: 40, row: 9, isShown: true });
    expect([(moved >> 11) & 7, (moved >> 14) & 3]).toEqual([5, 1]);
    const inav = osdBits({ column: 40, row: 9, isShown: false }, 0, 'INAV');
    expect(osdPosition(inav, 'INAV')).toEqual({ column: 40, row: 9, isShown: false });
  });

  it('show numbers in forms, without lists and flags', () => {
    const names = formFields('VtxConfig', { vtx_type: 3, band: 1, channel: 2 }).map(({ name }) => name);
    expect(names).toEqual(['vtx_type', 'band', 'channel']);
    expect(vtxRequest({ band: 5, channel: 3 }).combined).toBe(34);
    expect(vtxRequest({ band: 0, channel: 1, frequency: 5800 }).combined).toBe(5800);
    expect([channelName(3), channelName(4)]).toEqual(['THROTTLE', 'AUX 1']);
  });
});
