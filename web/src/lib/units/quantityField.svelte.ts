/** A number that is entered in the user's unit: when the unit changes, the number follows, and the amount stays. */

import { settings } from '$lib/store/settings.svelte';

import { convert, toSi, unitOf, type Quantity } from './units';

export class QuantityField {
  private readonly quantity: Quantity;
  private entered: number | null = $state.raw(null);
  private system = $state.raw(settings.units.value);

  /** Creates a field with an amount in SI, shown as a whole number; null: empty. */
  constructor(quantity: Quantity, amount: number | null = null) {
    this.quantity = quantity;
    if (amount !== null) this.shown = Math.round(convert(amount, quantity));
  }

  /** The number in the user's unit, as it was entered, or converted; null: empty. */
  get shown(): number | null {
    const { entered, system, quantity } = this;
    if (entered === null || system === settings.units.value) return entered;
    return Number(convert(toSi(entered, quantity, system), quantity).toFixed(unitOf(quantity).digits));
  }

  set shown(value: number | null) {
    this.entered = value;
    this.system = settings.units.value;
  }

  /** The amount that is shown, in SI; null: empty. */
  get amount(): number | null {
    return this.shown === null ? null : toSi(this.shown, this.quantity);
  }
}
