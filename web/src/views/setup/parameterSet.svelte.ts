/** The parameters of the selected vehicle, which all panels of the set-up share. */

import { api } from '$lib/api/client';
import { textOf } from '$lib/api/errors';
import { t } from '$lib/i18n';
import { status } from '$lib/store/status.svelte';
import type { Parameter, Vehicle } from '$lib/vehicle/Vehicle';
import { toast, toastError } from '$lib/ui/toasts.svelte';

import { EMPTY_METADATA, rowsOf, type MetadataTable, type ParameterTable, type Row } from './logic/parameters';

class ParameterSet {
  vehicle: Vehicle | null = $state.raw(null);
  parameters: ParameterTable = $state.raw({});
  metadata: MetadataTable = $state.raw({});
  /** Why the vehicle gave no metadata; empty: it did. */
  metadataProblem = $state('');
  isLoading = $state(false);
  done = $state(0);
  total: number | null = $state(null);
  problem: string | null = $state(null);
  /** The values before they were changed on this page. */
  before: Readonly<Record<string, number>> = $state.raw({});
  /** A parameter was changed that takes effect after a reboot. */
  needsReboot = $state(false);

  readonly rows: Row[] = $derived(rowsOf(this.parameters, this.metadata));
  readonly isEmpty: boolean = $derived(Object.keys(this.parameters).length === 0);

  /** Shows the parameters of a vehicle: those that are known, or a download. */
  use(vehicle: Vehicle): void {
    if (this.vehicle === vehicle) return;
    this.vehicle = vehicle;
    this.parameters = {};
    this.metadata = {};
    this.before = {};
    this.needsReboot = false;
    [this.problem, this.isLoading] = [null, false];
    if (vehicle.capabilities.params !== false) void this.load(vehicle);
  }

  async load(vehicle: Vehicle | null = this.vehicle): Promise<void> {
    if (!vehicle) return;
    this.isLoading = true;
    this.problem = null;
    [this.done, this.total] = [0, null];
    try {
      const found = await vehicle.getParameters((done, total) => {
        if (vehicle === this.vehicle) [this.done, this.total] = [done, total];
      });
      if (vehicle !== this.vehicle) return;
      this.parameters = Object.fromEntries(found.map((each) => [each.name, each]));
      await this.loadMetadata(vehicle);
    } catch (error) {
      if (vehicle === this.vehicle) this.problem = textOf(error);
    } finally {
      if (vehicle === this.vehicle) this.isLoading = false;
    }
  }

  /** Only the station's server reads the component information of the vehicle. */
  private async loadMetadata(vehicle: Vehicle): Promise<void> {
    if (status.source !== 'server') return;
    interface Answer {
      readonly metadata: Readonly<Record<string, object>>;
      readonly problem: string | null;
    }
    try {
      const answer = await api.longJson<Answer>('GET', `vehicles/${vehicle.system}/parameter-metadata`);
      if (vehicle !== this.vehicle) return;
      const whole = Object.entries(answer.metadata).map(([name, facts]) => [name, { ...EMPTY_METADATA, ...facts }]);
      this.metadata = Object.fromEntries(whole) as MetadataTable;
      this.metadataProblem = answer.problem ?? '';
    } catch (error) {
      this.metadataProblem = textOf(error);
    }
  }

  /** Sets a parameter; the value that the vehicle holds then is shown. Resolves to its success. */
  async set(name: string, value: number): Promise<boolean> {
    const { vehicle } = this;
    if (!vehicle) return false;
    try {
      this.take(await vehicle.setParameter(name, value));
      if (this.metadata[name]?.reboot_required) this.needsReboot = true;
      return true;
    } catch (error) {
      toastError(error);
      return false;
    }
  }

  /** Sets several parameters one after the other; tells those that the vehicle refused. */
  async setAll(values: ReadonlyMap<string, number>): Promise<void> {
    const { vehicle } = this;
    const failed: string[] = [];
    let done = 0;
    this.isLoading = true;
    for (const [name, value] of values) {
      [this.done, this.total] = [done, values.size];
      try {
        if (vehicle) this.take(await vehicle.setParameter(name, value));
        if (this.metadata[name]?.reboot_required) this.needsReboot = true;
      } catch (error) {
        failed.push(`${name}: ${textOf(error)}`);
      }
      done += 1;
    }
    this.isLoading = false;
    const written = t('setup.written', { count: values.size - failed.length });
    if (failed.length) toast('error', t('setup.notWritten', { count: failed.length }), failed.slice(0, 8));
    else toast('ok', written);
  }

  private take(held: Parameter): void {
    const before = this.parameters[held.name];
    if (before && !(held.name in this.before)) this.before = { ...this.before, [held.name]: before.value };
    if (this.before[held.name] === held.value) {
      const { [held.name]: _, ...others } = this.before;
      this.before = others;
    }
    this.parameters = { ...this.parameters, [held.name]: held };
  }
}

export const parameterSet = new ParameterSet();
