/**
 * The grid of a dashboard: widgets on twelve columns that never overlap.
 *
 * A widget that is moved or resized pushes those that it covers down; then all rise as far as they can.
 */
import type { Dashboard, Widget } from './model';

export const COLUMNS = 12;
export const MAX_HEIGHT = 24;
const MAX_ROWS = 1000;

export interface Place {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/** Returns a place within the grid. */
export function clampPlace(place: Place): Place {
  const width = clamp(Math.round(place.width), 1, COLUMNS);
  return {
    x: clamp(Math.round(place.x), 0, COLUMNS - width),
    y: clamp(Math.round(place.y), 0, MAX_ROWS),
    width,
    height: clamp(Math.round(place.height), 1, MAX_HEIGHT),
  };
}

export function overlaps(a: Place, b: Place): boolean {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/** Returns the widgets without overlaps and without empty rows above them; `first` keeps its place before others. */
export function compacted(widgets: readonly Widget[], first?: string): Widget[] {
  const order = [...widgets].sort((a, b) => a.y - b.y || Number(b.id === first) - Number(a.id === first) || a.x - b.x);
  const placed: Widget[] = [];
  for (const widget of order) {
    let place = clampPlace(widget);
    while (placed.some((other) => overlaps(place, other))) place = { ...place, y: place.y + 1 };
    while (place.y > 0 && !placed.some((other) => overlaps({ ...place, y: place.y - 1 }, other))) {
      place = { ...place, y: place.y - 1 };
    }
    placed.push({ ...widget, ...place });
  }
  return widgets.map((widget) => placed.find((each) => each.id === widget.id)!);
}

/** Returns a dashboard with a widget at another place. */
export function withPlace(dashboard: Dashboard, id: string, place: Place): Dashboard {
  const target = clampPlace(place);
  const moved = dashboard.widgets.map((widget) => (widget.id === id ? { ...widget, ...target } : widget));
  // Covered widgets go below the moved one before everything rises.
  const bottom = target.y + target.height;
  const pushed = moved.map((widget) =>
    widget.id !== id && overlaps(widget, target) ? { ...widget, y: bottom } : widget,
  );
  return { ...dashboard, widgets: compacted(pushed, id) };
}

/** Returns a dashboard with one more widget, below the others. */
export function withWidget(dashboard: Dashboard, widget: Omit<Widget, 'id' | 'x' | 'y'>): Dashboard {
  const numbers = dashboard.widgets.map((each) => Number(/^w(\d+)$/.exec(each.id)?.[1] ?? 0));
  const id = `w${Math.max(0, ...numbers) + 1}`;
  const y = Math.max(0, ...dashboard.widgets.map((each) => each.y + each.height));
  return { ...dashboard, widgets: compacted([...dashboard.widgets, { ...widget, id, x: 0, y }]) };
}

export function withoutWidget(dashboard: Dashboard, id: string): Dashboard {
  return { ...dashboard, widgets: compacted(dashboard.widgets.filter((widget) => widget.id !== id)) };
}

/** Returns the number of rows. */
export function rowsOf(widgets: readonly Widget[]): number {
  return Math.max(0, ...widgets.map((widget) => widget.y + widget.height));
}

/** Returns the widgets in the order in which a phone shows them, one below the other. */
export function readingOrder(widgets: readonly Widget[]): Widget[] {
  return [...widgets].sort((a, b) => a.y - b.y || a.x - b.x);
}

function clamp(value: number, low: number, high: number): number {
  return Math.min(high, Math.max(low, Number.isFinite(value) ? value : low));
}
