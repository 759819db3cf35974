import { describe, expect, it } from 'vitest';

import { baselineOf, fixOf, remoteIdOf } from './reports';

describe('reports of services', () => {
  it('say how precise the position is', () => {
    const fields = { fix_type: 6, satellites_visible: 21, h_acc: 14, v_acc: 0 };
    expect(fixOf(fields)).toEqual({
      text: 'payload.fixFixed',
      isPrecise: true,
      satellites: 21,
      horizontal: 0.014,
      vertical: null,
    });
    expect(fixOf({ fix_type: 3, satellites_visible: 255 })).toMatchObject({ isPrecise: false, satellites: null });
  });

  it('have the baseline of RTK', () => {
    const fields = { baseline_a_mm: 3000, baseline_b_mm: 4000, baseline_c_mm: 0, rtk_rate: 1, nsats: 12 };
    expect(baselineOf(fields)).toEqual({ length: 5, rate: 1, satellites: 12 });
  });

  it('have the reason of Remote ID not to arm', () => {
    expect(remoteIdOf({ status: 1, error: 'missing operator location ' })).toEqual({
      isReady: false,
      reason: 'missing operator location',
    });
    expect(remoteIdOf({ status: 0, error: '' }).isReady).toBe(true);
  });
});
