/** Undo and redo over immutable values. */

const MAX_STEPS = 200;

export interface History<T> {
  readonly past: readonly T[];
  readonly present: T;
  readonly future: readonly T[];
  /** Edits of one gesture, such as a drag, share a key and are undone together. */
  readonly key: string | null;
}

export function begin<T>(present: T): History<T> {
  return { past: [], present, future: [], key: null };
}

/** Adds a value; it replaces the present one if both have the same key that is not null. */
export function commit<T>(history: History<T>, present: T, key: string | null = null): History<T> {
  if (present === history.present) return history;
  if (key !== null && key === history.key) return { ...history, present, future: [] };
  return { past: [...history.past, history.present].slice(-MAX_STEPS), present, future: [], key };
}

export function undo<T>(history: History<T>): History<T> {
  const previous = history.past.at(-1);
  if (previous === undefined) return history;
  const future = [history.present, ...history.future];
  return { past: history.past.slice(0, -1), present: previous, future, key: null };
}

export function redo<T>(history: History<T>): History<T> {
  const [next, ...future] = history.future;
  if (next === undefined) return history;
  return { past: [...history.past, history.present], present: next, future, key: null };
}
