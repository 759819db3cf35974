/** The parameters of the selected vehicle, which all panels of the set-up share. */

import { api } from '$lib/api/client';
import { textOf } from '$lib/api/errors';
import { t } from '$lib/i18n';
import { status } from '$lib/store/status.svelte';
import type { DecodedMessage } from '$lib/decoder/Decoder';
import { toast, toastError } from '$lib/ui/toasts.svelte';
import { parameterOf } from '$lib/vehicle/link/parameters';
import { encodingOf } from '$lib/vehicle/link/parameterValue';
import type { Parameter, Vehicle } from '$lib/vehicle/Vehicle';

import { EMPTY_METADATA, rowsOf, type MetadataTable, type ParameterTable, type Row } from './logic/parameters';

/** A value that was changed on this page. */
export interface Change {
  readonly name: string;
  readonly from: number;
  readonly to: number;
}

/** Values that were not written, of which vehicle. */
export interface Refusals {
  readonly vehicle: Vehicle;
  /** The name of each parameter with the reason. */
  readonly lines: readonly string[];
}

class ParameterSet {
  vehicle: Vehicle | null = $state.raw(null);
  parameters: ParameterTable = $state.raw({});
  metadata: MetadataTable = $state.raw({});
  /** Why the vehicle gave no metadata; empty: it did. */
  metadataProblem = $state('');
  isLoading = $state(false);
  isWriting = $state(false);
  done = $state(0);
  total: number | null = $state(null);
  problem: string | null = $state(null);
  /** The values before they were changed on this page. */
  before: Readonly<Record<string, number>> = $state.raw({});
  /** The changes of this page in their order, so that the last ones can be undone. */
  history: readonly Change[] = $state.raw([]);
  /** The values of the last file that the vehicle refused. */
  refused: Refusals | null = $state.raw(null);
  /** Vehicles of which a change takes effect after a reboot. */
  private rebooting: readonly Vehicle[] = $state.raw([]);
  /** Changes of one parameter are made one after the other. */
  private readonly changes = new Map<string, Promise<boolean>>();
  /** The names that are being written: their answers tell the values. */
  private readonly writing = new Set<string>();
  private endListening: (() => void) | null = null;
  /** Grows with each download: the answer to an earlier one is stale. */
  private loads = 0;

  readonly rows: Row[] = $derived(rowsOf(this.parameters, this.metadata));
  /** The names of parameters that a restart of the vehicle reverts, until they are saved. */
  readonly unsaved: readonly string[] = $derived(
    Object.values(this.parameters)
      .filter(({ saved }) => saved === false)
      .map(({ name }) => name),
  );
  readonly isEmpty: boolean = $derived(Object.keys(this.parameters).length === 0);
  readonly needsReboot: boolean = $derived(this.vehicle !== null && this.rebooting.includes(this.vehicle));

  /** Shows the parameters of a vehicle: those that are known, or a download. */
  use(vehicle: Vehicle): void {
    if (this.vehicle === vehicle) return;
    this.vehicle = vehicle;
    this.loads += 1;
    [this.parameters, this.metadata, this.before, this.history] = [{}, {}, {}, []];
    [this.problem, this.metadataProblem, this.isLoading, this.isWriting] = [null, '', false, false];
    this.changes.clear();
    this.endListening?.();
    this.endListening = vehicle.onMessage('PARAM_VALUE', (message) => this.takeAnnounced(vehicle, message));
    if (vehicle.capabilities.params !== false) void this.load(vehicle);
  }

  async load(vehicle: Vehicle | null = this.vehicle): Promise<void> {
    if (!vehicle) return;
    this.loads += 1;
    const load = this.loads;
    this.isLoading = true;
    this.problem = null;
    [this.done, this.total] = [0, null];
    try {
      const found = await vehicle.getParameters((done, total) => {
        if (load === this.loads) [this.done, this.total] = [done, total];
      });
      if (load !== this.loads) return;
      this.parameters = Object.fromEntries(found.map((each) => [each.name, each]));
      this.forgetRestored();
      await this.loadMetadata(vehicle, load);
    } catch (error) {
      if (load === this.loads) this.problem = textOf(error);
    } finally {
      if (load === this.loads) this.isLoading = false;
    }
  }

  /** Only the station's server reads the component information of the vehicle. */
  private async loadMetadata(vehicle: Vehicle, load: number): Promise<void> {
    if (status.source !== 'server') return;
    interface Answer {
      readonly metadata: Readonly<Record<string, object>>;
      readonly problem: string | null;
    }
    try {
      const answer = await api.longJson<Answer>('GET', `vehicles/${vehicle.system}/parameter-metadata`);
      if (load !== this.loads) return;
      const whole = Object.entries(answer.metadata).map(([name, facts]) => [name, { ...EMPTY_METADATA, ...facts }]);
      // A file that was opened before is kept where the vehicle gives none.
      if (whole.length > 0) this.metadata = Object.fromEntries(whole) as MetadataTable;
      this.metadataProblem = answer.problem ?? '';
    } catch (error) {
      if (load === this.loads) this.metadataProblem = textOf(error);
    }
  }

  /**
   * Sets a parameter; the value that the vehicle holds then is shown. Resolves to its success.
   *
   * @param value - The value, or a function of the value that is held when earlier changes are made.
   */
  set(name: string, value: number | ((held: number) => number)): Promise<boolean> {
    const { vehicle } = this;
    const earlier = this.changes.get(name) ?? Promise.resolve(true);
    const change = earlier.then(() => (vehicle ? this.change(vehicle, name, value) : false));
    this.changes.set(name, change);
    return change;
  }

  private async change(vehicle: Vehicle, name: string, value: number | ((held: number) => number)): Promise<boolean> {
    // Another vehicle was selected while an earlier change was made.
    if (vehicle !== this.vehicle) return false;
    const held = this.parameters[name]?.value ?? NaN;
    const { metadata } = this;
    try {
      await this.write(vehicle, name, typeof value === 'number' ? value : value(held));
      if (metadata[name]?.reboot_required) this.requireReboot(vehicle);
      return true;
    } catch (error) {
      toastError(error);
      return false;
    }
  }

  /** Sets the parameter of the last change back; resolves to its success. */
  async undo(): Promise<boolean> {
    const { history } = this;
    const last = history.at(-1);
    if (!last || !(await this.set(last.name, last.from))) return false;
    // Setting it back is not a change to undo.
    this.history = history.slice(0, -1);
    return true;
  }

  /** Sets all parameters that this page changed back to their values of before. */
  async undoAll(): Promise<void> {
    await this.setAll(new Map(Object.entries(this.before)));
    if (Object.keys(this.before).length === 0) this.history = [];
  }

  /** Sets several parameters one after the other, also while another vehicle is shown; tells what was refused. */
  async setAll(values: ReadonlyMap<string, number>): Promise<void> {
    const { vehicle, metadata } = this;
    if (!vehicle) return;
    const lines: string[] = [];
    let done = 0;
    this.refused = null;
    for (const [name, value] of values) {
      if (vehicle === this.vehicle) [this.isWriting, this.done, this.total] = [true, done, values.size];
      try {
        await this.write(vehicle, name, value);
        if (metadata[name]?.reboot_required) this.requireReboot(vehicle);
      } catch (error) {
        lines.push(`${name}: ${textOf(error)}`);
      }
      done += 1;
    }
    if (vehicle === this.vehicle) this.isWriting = false;
    if (lines.length) this.refused = { vehicle, lines };
    if (lines.length < values.size) toast('ok', t('setup.written', { count: values.size - lines.length }));
  }

  private async write(vehicle: Vehicle, name: string, value: number): Promise<void> {
    this.writing.add(name);
    try {
      this.take(vehicle, await vehicle.setParameter(name, value));
    } finally {
      this.writing.delete(name);
    }
  }

  /** Shows a value that a calibration, another ground station or the vehicle itself has changed. */
  private takeAnnounced(vehicle: Vehicle, message: DecodedMessage): void {
    if (message.component !== vehicle.state.component || this.isLoading) return;
    const known = this.parameters[String(message.fields.param_id)];
    if (!known || this.writing.has(known.name)) return;
    // Floats are the same in all encodings.
    const encoding = encodingOf(vehicle.state.firmware) ?? (known.type === 'REAL32' ? 'cast' : null);
    if (encoding === null) return;
    const held = parameterOf(message, encoding);
    if (Math.fround(held.value) === Math.fround(known.value)) return;
    this.parameters = { ...this.parameters, [known.name]: held };
    this.forgetRestored();
  }

  /** Removes the marks of parameters that have their values of before again, such as by another ground station. */
  private forgetRestored(): void {
    const { parameters } = this;
    const changed = Object.entries(this.before).filter(([name, value]) => {
      const held = parameters[name]?.value;
      return held === undefined || Math.fround(held) !== Math.fround(value);
    });
    if (changed.length < Object.keys(this.before).length) this.before = Object.fromEntries(changed);
  }

  /** Saves all parameters of the vehicle, so that they outlast a restart; resolves to its success. */
  async save(): Promise<void> {
    const { vehicle } = this;
    if (!vehicle) return;
    await vehicle.perform('commit-parameters', {});
    if (vehicle !== this.vehicle) return;
    const saved = Object.values(this.parameters).map((each) => [each.name, { ...each, saved: true }]);
    this.parameters = Object.fromEntries(saved) as ParameterTable;
  }

  requireReboot(vehicle: Vehicle): void {
    if (!this.rebooting.includes(vehicle)) this.rebooting = [...this.rebooting, vehicle];
  }

  /** The vehicle was rebooted. */
  rebooted(vehicle: Vehicle): void {
    this.rebooting = this.rebooting.filter((each) => each !== vehicle);
  }

  /** Shows the value that a vehicle holds, unless another vehicle was selected while it was written. */
  private take(vehicle: Vehicle, held: Parameter): void {
    if (vehicle !== this.vehicle) return;
    const before = this.parameters[held.name];
    if (before && Math.fround(before.value) !== Math.fround(held.value)) {
      this.history = [...this.history, { name: held.name, from: before.value, to: held.value }];
    }
    if (before && !(held.name in this.before)) this.before = { ...this.before, [held.name]: before.value };
    this.parameters = { ...this.parameters, [held.name]: held };
    this.forgetRestored();
  }
}

export const parameterSet = new ParameterSet();
