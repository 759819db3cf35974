/** Dashboards as they are shown, edited and saved: a JSON object that people can read and write by hand. */
import { type FieldRef, formatFieldRef, parseFieldRef } from '$lib/series/fieldRef';
import { parseDecoder } from '$lib/frames/decoder';
import { problemOf } from '$lib/scripts/sandbox';
import type { NamedDecoder } from '$lib/sources/stationSources';

import { compacted } from './layout';

export const WIDGET_KINDS = ['plot', 'gauge', 'value', 'text', 'horizon', 'compass', 'attitude', 'map', 'fft'] as const;
export type WidgetKind = (typeof WIDGET_KINDS)[number];

export interface WidgetField {
  readonly ref: FieldRef;
  /** Name in the legend; empty: that of the reference. */
  readonly label: string;
  /** The value is shown after `value * factor + offset`. */
  readonly factor: number;
  readonly offset: number;
  readonly unit: string;
}

export interface Widget {
  readonly id: string;
  readonly kind: WidgetKind;
  readonly title: string;
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
  readonly fields: readonly WidgetField[];
  /** Limits of a gauge. */
  readonly minimum: number;
  readonly maximum: number;
  /** Seconds that a plot shows. */
  readonly window: number;
  readonly decimals: number;
  /** Markdown-free text of a text widget, with `{1}` for the value of the first field. */
  readonly text: string;
}

export interface UserScript {
  /** Name of its source: `script:NAME`. */
  readonly name: string;
  /** Fields by the names under which the script reads them in `values`. */
  readonly inputs: Readonly<Record<string, FieldRef>>;
  /** The source whose frames the script reads as `bytes`; empty: it reads its inputs. */
  readonly frames: string;
  readonly code: string;
}

export interface Dashboard {
  readonly title: string;
  /** Sources that the station needs for it, offered to be added. */
  readonly sources: readonly string[];
  readonly widgets: readonly Widget[];
  readonly scripts: readonly UserScript[];
  readonly decoders: readonly NamedDecoder[];
}

export const FILE_TYPE = 'mavstack-dashboard';
export const PROJECT_TYPE = 'mavstack-project';
export const FILE_VERSION = 1;
export const MAX_WIDGETS = 100;
/** A plot of more fields cannot be read. */
export const MAX_WIDGET_FIELDS = 32;
/** Each script is a thread of the browser. */
export const MAX_SCRIPTS = 16;
export const MAX_INPUTS = 32;
export const MAX_SOURCES = 32;
export const MAX_DECODERS = 32;
export const MAX_DASHBOARDS = 100;
/** Characters of a file. */
export const MAX_TEXT = 2_000_000;
export const EMPTY: Dashboard = { title: 'New dashboard', sources: [], widgets: [], scripts: [], decoders: [] };

/** Default size of a kind of widget, in columns and rows. */
export const DEFAULT_SIZES: Readonly<Record<WidgetKind, readonly [number, number]>> = {
  plot: [6, 5],
  gauge: [3, 4],
  value: [3, 2],
  text: [3, 2],
  horizon: [3, 5],
  compass: [3, 5],
  attitude: [3, 5],
  map: [6, 7],
  fft: [6, 5],
};

/** The fields that a kind takes, in their order; a plot takes any number. */
export const FIELD_ROLES: Readonly<Record<WidgetKind, readonly string[] | null>> = {
  plot: null,
  gauge: ['value'],
  value: ['value'],
  text: null,
  horizon: ['roll', 'pitch'],
  compass: ['heading'],
  attitude: ['roll', 'pitch', 'yaw'],
  map: null,
  fft: null,
};

export class DashboardError extends Error {}

/** Returns a field with defaults for all but its reference. */
export function fieldOf(ref: FieldRef, options: Partial<Omit<WidgetField, 'ref'>> = {}): WidgetField {
  return { ref, label: '', factor: 1, offset: 0, unit: '', ...options };
}

/** Returns a widget of a kind with defaults, without a place. */
export function newWidget(
  kind: WidgetKind,
  fields: readonly WidgetField[] = [],
  title = '',
): Omit<Widget, 'id' | 'x' | 'y'> {
  const [width, height] = DEFAULT_SIZES[kind];
  return { kind, title, width, height, fields, minimum: 0, maximum: 100, window: 30, decimals: 1, text: '' };
}

/** Returns the text of a file. */
export function saveDashboard(dashboard: Dashboard): string {
  return asFile(savedDashboard(dashboard));
}

/** Returns the text of a file with several dashboards. */
export function saveProject(dashboards: readonly Dashboard[]): string {
  return asFile({ type: PROJECT_TYPE, version: FILE_VERSION, dashboards: dashboards.map(savedDashboard) });
}

function asFile(value: object): string {
  return `${JSON.stringify(value, null, 2)}\n`;
}

function savedDashboard(dashboard: Dashboard): object {
  const widgets = dashboard.widgets.map((widget) => ({ ...widget, fields: widget.fields.map(savedField) }));
  const scripts = dashboard.scripts.map(({ name, inputs, frames, code }) => ({
    name,
    ...(frames && { frames }),
    inputs: Object.fromEntries(Object.entries(inputs).map(([input, ref]) => [input, formatFieldRef(ref)])),
    code,
  }));
  const { title, sources } = dashboard;
  const decoders = dashboard.decoders.map(({ declaration }) => declaration);
  return { type: FILE_TYPE, version: FILE_VERSION, title, sources, widgets, scripts, decoders };
}

function savedField({ ref, label, factor, offset, unit }: WidgetField): Record<string, unknown> {
  return {
    ref: formatFieldRef(ref),
    ...(label && { label }),
    ...(factor !== 1 && { factor }),
    ...(offset !== 0 && { offset }),
    ...(unit && { unit }),
  };
}

/**
 * Returns the dashboard of a text; throws a DashboardError that says what is wrong.
 *
 * Widgets of unknown kinds and unknown members are left out, so that files of newer versions can be opened.
 */
export function loadDashboard(text: string): Dashboard {
  return readDashboard(parse(text));
}

/** Returns the dashboards of a file: of a dashboard, or of a project with several; throws a DashboardError. */
export function loadFile(text: string): readonly Dashboard[] {
  const value = parse(text);
  if (!isObject(value) || value.type !== PROJECT_TYPE) return [readDashboard(value)];
  if (value.version !== FILE_VERSION) throw new DashboardError(`this project has the version ${value.version}`);
  const dashboards = list(value.dashboards);
  if (dashboards.length > MAX_DASHBOARDS)
    throw new DashboardError(`${dashboards.length} dashboards are too many: at most ${MAX_DASHBOARDS} fit`);
  if (dashboards.length === 0) throw new DashboardError('this project has no dashboard');
  return dashboards.map((each, index) => {
    try {
      return readDashboard(each);
    } catch (error) {
      throw new DashboardError(`dashboard ${index + 1}: ${(error as Error).message}`);
    }
  });
}

function parse(text: string): unknown {
  if (text.length > MAX_TEXT) throw new DashboardError(`not a dashboard: longer than ${MAX_TEXT} characters`);
  try {
    return JSON.parse(text);
  } catch (error) {
    throw new DashboardError(`not a dashboard: ${(error as Error).message}`);
  }
}

function readDashboard(value: unknown): Dashboard {
  if (!isObject(value) || value.type !== FILE_TYPE)
    throw new DashboardError(`not a dashboard: no "type": "${FILE_TYPE}"`);
  if (value.version !== FILE_VERSION) throw new DashboardError(`this dashboard has the version ${value.version}`);
  const widgets = list(value.widgets).slice(0, MAX_WIDGETS).flatMap(loadWidget);
  if (new Set(widgets.map((widget) => widget.id)).size < widgets.length) {
    throw new DashboardError('two widgets have the same id');
  }
  const scripts = list(value.scripts).flatMap(loadScript);
  if (scripts.length > MAX_SCRIPTS)
    throw new DashboardError(`${scripts.length} scripts are too many: at most ${MAX_SCRIPTS} can run`);
  const repeated = scripts.find(({ name }, index) => scripts.findIndex((each) => each.name === name) < index);
  if (repeated) throw new DashboardError(`two scripts have the name ${repeated.name}`);
  return {
    title: string(value.title, EMPTY.title),
    sources: distinct(list(value.sources).filter((each) => typeof each === 'string')).slice(0, MAX_SOURCES),
    decoders: loadDecoders(value.decoders),
    // Places that no grid has are moved into it.
    widgets: compacted(widgets),
    scripts,
  };
}

function loadWidget(value: unknown, index: number): Widget[] {
  if (!isObject(value)) return [];
  const kind = WIDGET_KINDS.find((each) => each === value.kind);
  if (kind === undefined) return [];
  const [width, height] = DEFAULT_SIZES[kind];
  return [
    {
      id: string(value.id, `w${index + 1}`),
      kind,
      title: string(value.title, ''),
      x: number(value.x, 0),
      y: number(value.y, 0),
      width: number(value.width, width),
      height: number(value.height, height),
      fields: list(value.fields)
        .slice(0, MAX_WIDGET_FIELDS)
        .map((field) => loadField(field, index)),
      minimum: number(value.minimum, 0),
      maximum: number(value.maximum, 100),
      window: Math.min(3600, Math.max(1, number(value.window, 30))),
      decimals: Math.min(9, Math.max(0, Math.round(number(value.decimals, 1)))),
      text: string(value.text, ''),
    },
  ];
}

function loadField(value: unknown, index: number): WidgetField {
  const object = typeof value === 'string' ? { ref: value } : isObject(value) ? value : {};
  return fieldOf(loadRef(object.ref, `widget ${index + 1}`), {
    label: string(object.label, ''),
    factor: number(object.factor, 1),
    offset: number(object.offset, 0),
    unit: string(object.unit, ''),
  });
}

function loadRef(value: unknown, place: string): FieldRef {
  const ref = typeof value === 'string' ? parseFieldRef(value) : null;
  if (ref === null)
    throw new DashboardError(`${place}: ${JSON.stringify(value)} is not a field such as 1/1:ATTITUDE.roll`);
  return ref;
}

function loadScript(value: unknown, index: number): UserScript[] {
  if (!isObject(value)) return [];
  const name = string(value.name, '');
  const code = string(value.code, '');
  const frames = string(value.frames, '');
  const problem = /^[A-Za-z][A-Za-z0-9_]{0,31}$/.test(name) ? problemOf(code) : 'it needs a name of letters and digits';
  if (problem !== null) throw new DashboardError(`script ${index + 1}: ${problem}`);
  const inputs = isObject(value.inputs) ? Object.entries(value.inputs).slice(0, MAX_INPUTS) : [];
  return [
    {
      name,
      code,
      frames,
      inputs: Object.fromEntries(inputs.map(([input, ref]) => [input, loadRef(ref, `script ${name}`)])),
    },
  ];
}

function loadDecoders(value: unknown): readonly NamedDecoder[] {
  const declarations = list(value).filter(isObject);
  if (declarations.length > MAX_DECODERS)
    throw new DashboardError(`${declarations.length} decoders are too many: at most ${MAX_DECODERS} fit`);
  const decoders = declarations.map((declaration, index) => {
    try {
      return { name: parseDecoder(declaration).name, declaration };
    } catch (error) {
      throw new DashboardError(`decoder ${index + 1}: ${(error as Error).message}`);
    }
  });
  const names = decoders.map(({ name }) => name);
  const repeated = names.find((name, index) => names.indexOf(name) < index);
  if (repeated !== undefined) throw new DashboardError(`two decoders have the name ${repeated}`);
  return decoders;
}

/** Returns texts without repeated ones: pages use them as keys. */
export function distinct(texts: readonly string[]): readonly string[] {
  return [...new Set(texts)];
}

function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

function list(value: unknown): readonly unknown[] {
  return Array.isArray(value) ? value : [];
}

function string(value: unknown, fallback: string): string {
  return typeof value === 'string' ? value.slice(0, 100_000) : fallback;
}

function number(value: unknown, fallback: number): number {
  return typeof value === 'number' && Number.isFinite(value) ? value : fallback;
}
