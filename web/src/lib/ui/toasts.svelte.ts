/** Short messages at the edge of the page: results of actions, and reasons of refusals. */

import { StationError, textOf } from '$lib/api/errors';

export type ToastLevel = 'info' | 'ok' | 'warning' | 'error';

export interface Toast {
  readonly id: number;
  readonly level: ToastLevel;
  readonly text: string;
  /** Further lines, such as the vehicle's reasons. */
  readonly details: readonly string[];
}

const DURATION = 6000;
const ERROR_DURATION = 12_000;
const MAX_TOASTS = 4;

class Toasts {
  list: readonly Toast[] = $state.raw([]);
  private count = 0;

  show(level: ToastLevel, text: string, details: readonly string[] = []): void {
    this.count += 1;
    const id = this.count;
    this.list = [...this.list, { id, level, text, details }].slice(-MAX_TOASTS);
    setTimeout(() => this.dismiss(id), level === 'error' ? ERROR_DURATION : DURATION);
  }

  dismiss(id: number): void {
    this.list = this.list.filter((toast) => toast.id !== id);
  }
}

const toasts = new Toasts();
export { toasts };

export function toast(level: ToastLevel, text: string, details: readonly string[] = []): void {
  toasts.show(level, text, details);
}

/** Shows an error with the vehicle's reasons. */
export function toastError(error: unknown): void {
  const details = error instanceof StationError ? error.statusTexts : [];
  const text = textOf(error);
  toasts.show(
    'error',
    text,
    details.filter((detail) => !text.includes(detail)),
  );
}

/** Does an action; tells its success if there is a text for it, and always its failure. Resolves to its success. */
export async function attempt(action: () => Promise<unknown>, success?: string): Promise<boolean> {
  try {
    await action();
    if (success !== undefined) toasts.show('ok', success);
    return true;
  } catch (error) {
    toastError(error);
    return false;
  }
}
