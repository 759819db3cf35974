/** Actions of pilots on one or several vehicles: their outcome, and the vehicle's reasons if it refuses. */
import { StationError, textOf } from '$lib/api/errors';
import { t } from '$lib/i18n';
import { toast } from '$lib/ui/toasts.svelte';
import type { Vehicle } from '$lib/vehicle/Vehicle';

export interface Refusal {
  readonly system: number;
  readonly action: string;
  readonly text: string;
  /** Status texts of the vehicle. */
  readonly reasons: readonly string[];
  /** Number of the action, counted from 1. */
  readonly run: number;
}

class Actions {
  /** Names of actions that have not ended. */
  pending: readonly string[] = $state.raw([]);
  /** Refusals of the last action, and of later ones that were answered before it; empty after one that was accepted. */
  refusals: readonly Refusal[] = $state.raw([]);
  private runs = 0;

  isPending(action: string): boolean {
    return this.pending.includes(action);
  }

  dismiss(): void {
    this.refusals = [];
  }

  /** Lets all vehicles do an action at once; resolves to those that accepted. */
  async run(
    action: string,
    vehicles: readonly Vehicle[],
    act: (vehicle: Vehicle) => Promise<unknown>,
  ): Promise<Vehicle[]> {
    this.runs += 1;
    const run = this.runs;
    this.pending = [...this.pending, action];
    const outcomes = await Promise.allSettled(vehicles.map(act));
    const at = this.pending.indexOf(action);
    this.pending = this.pending.filter((_, index) => index !== at);
    // An answer that comes late must not hide the refusal of an action that was given after it.
    const later = this.refusals.filter((refusal) => refusal.run > run);
    this.refusals = [...refusalsOf(action, vehicles, outcomes, run), ...later];
    const accepted = vehicles.filter((_, index) => outcomes[index]!.status === 'fulfilled');
    if (accepted.length === 1 && vehicles.length === 1) toast('ok', t('fly.done', { action }));
    else if (accepted.length > 0) toast('ok', t('fly.doneAll', { action, count: accepted.length }));
    return accepted;
  }
}

/** Returns what was refused, with the reasons that the text does not hold already. */
export function refusalsOf(
  action: string,
  vehicles: readonly Pick<Vehicle, 'system'>[],
  outcomes: readonly PromiseSettledResult<unknown>[],
  run = 0,
): Refusal[] {
  return outcomes.flatMap((outcome, index) => {
    if (outcome.status === 'fulfilled') return [];
    const error: unknown = outcome.reason;
    // The pilot himself gave another command.
    if (error instanceof StationError && error.kind === 'Cancelled') return [];
    const text = textOf(error);
    const given = error instanceof StationError ? error.statusTexts : [];
    const reasons = [...new Set(given)].filter((reason) => !text.includes(reason));
    return [{ system: vehicles[index]!.system, action, text, reasons, run }];
  });
}

export const actions = new Actions();
