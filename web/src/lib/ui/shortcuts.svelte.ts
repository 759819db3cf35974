/** Keyboard shortcuts: those of the shell, and those that the shown view adds. */

import { untrack } from 'svelte';

export interface Shortcut {
  /** Key as `KeyboardEvent.key`; two keys one after the other: `g 1`. */
  readonly keys: string;
  readonly label: string;
  readonly run: () => void;
}

/** Time in ms in which the second key of two must follow. */
const SEQUENCE_TIMEOUT = 1000;

class Shortcuts {
  list: readonly Shortcut[] = $state.raw([]);
  private first = { key: '', time: 0 };

  /** Adds shortcuts; returns the function that removes them: `$effect(() => shortcuts.add([…]))`. */
  add(added: readonly Shortcut[]): () => void {
    // An effect that adds shortcuts must not follow the list, which it changes.
    this.list = [...untrack(() => this.list), ...added];
    return () => (this.list = untrack(() => this.list).filter((shortcut) => !added.includes(shortcut)));
  }

  /** Runs the shortcut of a key, unless the user writes a text. */
  handle(event: KeyboardEvent, now: number = Date.now()): void {
    if (event.ctrlKey || event.metaKey || event.altKey || isWriting(event.target)) return;
    const recent = now - this.first.time < SEQUENCE_TIMEOUT;
    const pair = recent ? this.list.find(({ keys }) => keys === `${this.first.key} ${event.key}`) : undefined;
    const shortcut = pair ?? this.list.find(({ keys }) => keys === event.key);
    this.first = { key: event.key, time: now };
    if (shortcut === undefined) return;
    event.preventDefault();
    shortcut.run();
  }
}

function isWriting(target: EventTarget | null): boolean {
  if (typeof HTMLElement === 'undefined' || !(target instanceof HTMLElement)) return false;
  return target.isContentEditable || target.closest('input, select, textarea, dialog') !== null;
}

export const shortcuts = new Shortcuts();
