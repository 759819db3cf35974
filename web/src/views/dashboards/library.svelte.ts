/** The dashboards of the user, kept in the browser, and the one that is shown. */
import { Persisted } from '$lib/store/settings.svelte';

import { EXAMPLES } from './examples';
import { EMPTY, loadDashboard, saveDashboard, type Dashboard } from './model';

interface Stored {
  readonly id: string;
  readonly text: string;
}

export interface Entry {
  readonly id: string;
  readonly dashboard: Dashboard;
}

class Library {
  private readonly stored = new Persisted<readonly Stored[]>('dashboards.list', []);
  private readonly shown = new Persisted<string>('dashboards.shown', EXAMPLES[0]!.id);

  /** The user's own dashboards. */
  own: readonly Entry[] = $derived(this.stored.value.flatMap(readEntry));

  current: Entry = $derived.by(() => {
    const example = EXAMPLES.find(({ id }) => id === this.shown.value);
    const own = this.own.find(({ id }) => id === this.shown.value);
    return own ?? (example === undefined ? { id: EXAMPLES[0]!.id, dashboard: EXAMPLES[0]!.dashboard } : example);
  });

  /** Whether the shown dashboard is the user's; examples are copied before they change. */
  isOwn: boolean = $derived(this.own.some(({ id }) => id === this.current.id));

  show(id: string): void {
    this.shown.value = id;
  }

  /** Keeps a dashboard as a new one, and shows it. */
  add(dashboard: Dashboard): void {
    const numbers = this.stored.value.map(({ id }) => Number(id.replace('own-', '')) || 0);
    const id = `own-${Math.max(0, ...numbers) + 1}`;
    this.stored.value = [...this.stored.value, { id, text: saveDashboard(dashboard) }];
    this.shown.value = id;
  }

  /** Changes the shown dashboard; an example becomes a copy of the user's. */
  update(dashboard: Dashboard): void {
    const { id } = this.current;
    if (!this.isOwn) {
      this.add(dashboard);
      return;
    }
    const text = saveDashboard(dashboard);
    this.stored.value = this.stored.value.map((entry) => (entry.id === id ? { id, text } : entry));
  }

  addEmpty(title: string): void {
    this.add({ ...EMPTY, title });
  }

  remove(id: string): void {
    this.stored.value = this.stored.value.filter((entry) => entry.id !== id);
    if (this.shown.value === id) this.shown.value = EXAMPLES[0]!.id;
  }
}

function readEntry({ id, text }: Stored): Entry[] {
  try {
    return [{ id, dashboard: loadDashboard(text) }];
  } catch {
    // Of another version of the station: kept in the browser, not shown.
    return [];
  }
}

export const library = new Library();
