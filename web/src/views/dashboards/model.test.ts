import { describe, expect, it } from 'vitest';
import { parseFieldRef } from '$lib/series/fieldRef';
import {
  DashboardError,
  EMPTY,
  fieldOf,
  loadDashboard,
  loadFile,
  newWidget,
  saveDashboard,
  saveProject,
  type Dashboard,
} from './model';
import { withWidget } from './layout';

const ref = (text: string) => parseFieldRef(text)!;
const FULL: Dashboard = {
  ...withWidget(
    EMPTY,
    newWidget('plot', [fieldOf(ref('1:ATTITUDE.roll'), { factor: 57.3, unit: 'deg', label: 'Roll' })], 'Roll'),
  ),
  sources: ['tcpout://127.0.0.1:5760'],
  scripts: [
    { name: 'climb', inputs: { a: ref('cansat:ROW.altitude') }, frames: '', code: 'return { rate: values.a }' },
    { name: 'bytes', inputs: {}, frames: 'bench', code: 'return { size: bytes.length }' },
  ],
  decoders: [{ name: 'bench', declaration: { name: 'bench', framing: { kind: 'cobs' } } }],
};
const file = (value: object): string => JSON.stringify({ type: 'mavstack-dashboard', version: 1, ...value });

it('is the same after it was saved and loaded', () => {
  expect(loadDashboard(saveDashboard(FULL))).toEqual(FULL);
});

it('projects hold several dashboards, and are the same after they were saved and loaded', () => {
  const other = { ...FULL, title: 'Other' };
  expect(loadFile(saveProject([FULL, other]))).toEqual([FULL, other]);
  expect(loadFile(saveDashboard(FULL))).toEqual([FULL]);
});

it('has each source once', () => {
  expect(loadDashboard(file({ sources: ['a', 'b', 'a', 1] })).sources).toEqual(['a', 'b']);
});

it('takes short forms that people write', () => {
  const { widgets, title } = loadDashboard(file({ widgets: [{ kind: 'gauge', fields: ['1:VFR_HUD.alt'] }] }));
  expect(title).toBe('New dashboard');
  expect(widgets[0]).toMatchObject({ id: 'w1', width: 3, height: 4, maximum: 100 });
  expect(widgets[0]!.fields[0]!.ref.message).toBe('VFR_HUD');
});

it('leaves out what it does not know', () => {
  const { widgets } = loadDashboard(
    file({ widgets: [{ kind: 'hologram' }, 7, { kind: 'text', blink: true }], more: 1 }),
  );
  expect(widgets.map((widget) => widget.kind)).toEqual(['text']);
});

describe('refuses', () => {
  it.each([
    ['', 'not a dashboard'],
    ['[]', 'no "type"'],
    [file({ version: 9 }), 'version 9'],
    [file({ widgets: [{ kind: 'plot', fields: ['roll'] }] }), 'widget 1: "roll"'],
    [
      file({
        widgets: [
          { kind: 'plot', id: 'a' },
          { kind: 'plot', id: 'a' },
        ],
      }),
      'same id',
    ],
    [file({ scripts: [{ name: 'x', code: 'import("y")' }] }), 'script 1'],
    [file({ scripts: [{ name: 'no name', code: 'return {}' }] }), 'name of letters'],
    [file({ decoders: [{}, { framing: {} }] }), 'decoder 2: framing.kind'],
    [file({ decoders: [{}, {}] }), 'two decoders have the name decoder'],
    [file({ decoders: Array(33).fill({}) }), '33 decoders are too many'],
    [file({ type: 'mavstack-project', version: 2 }), 'version 2'],
    [file({ type: 'mavstack-project', dashboards: [] }), 'has no dashboard'],
    [file({ type: 'mavstack-project', dashboards: [{ type: 'x' }] }), 'dashboard 1: not a dashboard'],
    [file({ type: 'mavstack-project', dashboards: Array(101).fill({}) }), '101 dashboards are too many'],
  ])('%s', (text, reason) => {
    expect(() => loadFile(text)).toThrow(DashboardError);
    expect(() => loadFile(text)).toThrow(reason);
  });
});

describe('files of others', () => {
  const file = (members: object): string => JSON.stringify({ type: 'mavstack-dashboard', version: 1, ...members });
  const script = (name: string) => ({ name, code: 'return {}' });

  it('are moved into the grid, wherever their widgets are', () => {
    const places = [
      { y: 1e12, height: 1e9 },
      { x: -5, y: -7, width: 1e6 },
      { x: 3.6, width: 0, height: -1 },
    ];
    const { widgets } = loadDashboard(file({ widgets: places.map((place) => ({ kind: 'value', ...place })) }));
    expect(widgets).toHaveLength(3);
    for (const each of widgets) {
      for (const value of [each.x, each.y, each.width, each.height]) expect(Number.isInteger(value)).toBe(true);
      expect(each.x).toBeGreaterThanOrEqual(0);
      expect(each.x + each.width).toBeLessThanOrEqual(12);
      expect(each.y + each.height).toBeLessThan(50);
    }
  });

  it('start no more than the browser can run', () => {
    const many = (count: number) => Array.from({ length: count }, (_, index) => index);
    expect(() => loadDashboard(file({ scripts: many(17).map((each) => script(`s${each}`)) }))).toThrow(
      '17 scripts are too many',
    );
    expect(() => loadDashboard(file({ scripts: [script('a'), script('a')] }))).toThrow('two scripts have the name a');
    const fields = many(5000).map((each) => `1:A.f${each}`);
    expect(loadDashboard(file({ widgets: [{ kind: 'plot', fields }] })).widgets[0]!.fields).toHaveLength(32);
    expect(loadDashboard(file({ widgets: many(5000).map(() => ({ kind: 'value' })) })).widgets).toHaveLength(100);
    expect(loadDashboard(file({ sources: many(5000).map(String) })).sources).toHaveLength(32);
    expect(() => loadDashboard(' '.repeat(2_000_001))).toThrow('longer than');
  });

  it('change nothing but the dashboard', () => {
    const hostile =
      '{"type": "mavstack-dashboard", "version": 1, "__proto__": {"polluted": 1}, "scripts": [{"name": "a", ' +
      '"code": "return {}", "inputs": {"__proto__": "1:A.b", "constructor": "1:A.c"}}], "widgets": [{"kind": ' +
      '"__proto__"}, {"kind": "constructor"}, null, 5, [], {"kind": "text", "__proto__": {"x": 3}}]}';
    const loaded = loadDashboard(hostile);
    expect(loaded.widgets).toHaveLength(1);
    expect(Object.keys(loaded.scripts[0]!.inputs)).toEqual(['__proto__', 'constructor']);
    expect(({} as Record<string, unknown>).polluted).toBeUndefined();
    expect(loadDashboard(saveDashboard(loaded))).toEqual(loaded);
  });
});
