import { describe, expect, it } from 'vitest';
import { parseFieldRef } from '$lib/series/fieldRef';
import { DashboardError, EMPTY, fieldOf, loadDashboard, newWidget, saveDashboard, type Dashboard } from './model';
import { withWidget } from './layout';

const ref = (text: string) => parseFieldRef(text)!;
const FULL: Dashboard = {
  ...withWidget(EMPTY, newWidget('plot', [fieldOf(ref('1:ATTITUDE.roll'), { factor: 57.3, unit: 'deg', label: 'Roll' })], 'Roll')),
  sources: ['tcpout://127.0.0.1:5760'],
  scripts: [{ name: 'climb', inputs: { a: ref('cansat:ROW.altitude') }, code: 'return { rate: values.a }' }],
};
const file = (value: object): string => JSON.stringify({ type: 'mavstack-dashboard', version: 1, ...value });

it('is the same after it was saved and loaded', () => {
  expect(loadDashboard(saveDashboard(FULL))).toEqual(FULL);
});

it('takes short forms that people write', () => {
  const { widgets, title } = loadDashboard(file({ widgets: [{ kind: 'gauge', fields: ['1:VFR_HUD.alt'] }] }));
  expect(title).toBe('New dashboard');
  expect(widgets[0]).toMatchObject({ id: 'w1', width: 3, height: 4, maximum: 100 });
  expect(widgets[0]!.fields[0]!.ref.message).toBe('VFR_HUD');
});

it('leaves out what it does not know', () => {
  const { widgets } = loadDashboard(file({ widgets: [{ kind: 'hologram' }, 7, { kind: 'text', blink: true }], more: 1 }));
  expect(widgets.map((widget) => widget.kind)).toEqual(['text']);
});

describe('refuses', () => {
  it.each([
    ['', 'not a dashboard'],
    ['[]', 'no "type"'],
    [file({ version: 9 }), 'version 9'],
    [file({ widgets: [{ kind: 'plot', fields: ['roll'] }] }), 'widget 1: "roll"'],
    [file({ widgets: [{ kind: 'plot', id: 'a' }, { kind: 'plot', id: 'a' }] }), 'same id'],
    [file({ scripts: [{ name: 'x', code: 'import("y")' }] }), 'script 1'],
    [file({ scripts: [{ name: 'no name', code: 'return {}' }] }), 'name of letters'],
  ])('%s', (text, reason) => {
    expect(() => loadDashboard(text)).toThrow(DashboardError);
    expect(() => loadDashboard(text)).toThrow(reason);
  });
});
