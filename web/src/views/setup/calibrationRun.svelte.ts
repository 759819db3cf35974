/** A calibration that runs: by the station's server, or by the protocol in the page. */

import { api } from '$lib/api/client';
import { StationError, textOf } from '$lib/api/errors';
import { t } from '$lib/i18n';
import { status } from '$lib/store/status.svelte';
import type { Vehicle } from '$lib/vehicle/Vehicle';
import { toastError } from '$lib/ui/toasts.svelte';

import {
  CalibrationMachine,
  cancelCommand,
  inOrder,
  kindsOf,
  startCommand,
  type CalibrationStep,
} from './logic/calibration';
import { parameterSet } from './parameterSet.svelte';

export type RunState = 'running' | 'done' | 'failed' | 'cancelled';

interface TaskEvent {
  readonly state: RunState;
  readonly step?: CalibrationStep;
  readonly error?: { readonly text: string; readonly status_texts?: readonly string[] };
}

/** The result of a calibration, as the station's server tells it. */
export interface Outcome {
  readonly reboot_needed: boolean;
  readonly compasses: readonly { readonly id: number; readonly fitness: number }[];
  /** By the number of the channel, in µs. */
  readonly channels: Readonly<
    Record<string, { readonly minimum: number; readonly trim: number; readonly maximum: number }>
  >;
}

class CalibrationRun {
  kind: string | null = $state(null);
  state: RunState | null = $state(null);
  step: CalibrationStep | null = $state.raw(null);
  /** Lines about a failure: the reason, then the vehicle's texts. */
  reasons: readonly string[] = $state.raw([]);
  outcome: Outcome | null = $state.raw(null);
  vehicle: Vehicle | null = $state.raw(null);
  /** The step that was confirmed last: a second click must not confirm the next one. */
  private confirmed: string | null = $state(null);
  private machine: CalibrationMachine | null = null;
  private end: (() => void) | null = null;
  private task: string | null = null;
  private isCancelling = false;
  /** Grows with each calibration: answers for an earlier one are stale. */
  private run = 0;

  get isRunning(): boolean {
    return this.state === 'running';
  }

  /** The step waits for the person at the vehicle. */
  get waits(): boolean {
    return this.step?.needs_confirmation === true && this.confirmed !== keyOf(this.step);
  }

  /** The kinds that can be run for a vehicle. */
  kinds(vehicle: Vehicle): readonly string[] {
    return inOrder(status.source === 'server' ? vehicle.capabilities.calibration : kindsOf(vehicle.state.firmware));
  }

  async start(vehicle: Vehicle, kind: string): Promise<void> {
    if (this.isRunning) return;
    const run = this.begin(vehicle, kind);
    try {
      if (status.source === 'server') await this.startTask(vehicle, kind, run);
      else await this.startMachine(vehicle, kind, run);
    } catch (error) {
      if (run === this.run) this.fail(reasonsOf(error));
    }
  }

  /** Shows the calibration that the station runs for a vehicle: the page may have been loaded again meanwhile. */
  async resume(vehicle: Vehicle): Promise<void> {
    if (status.source !== 'server' || this.state !== null) return;
    const before = this.run;
    const path = `/api/vehicles/${vehicle.system}/calibrations/`;
    try {
      const tasks = await api.get<readonly { task: string; name: string; state: string }[]>('tasks');
      const found = tasks.find(({ name, state }) => state === 'running' && name.startsWith(`POST ${path}`));
      if (!found || this.run !== before || this.state !== null) return;
      this.follow(found.task, this.begin(vehicle, found.name.slice(`POST ${path}`.length)));
    } catch {
      // Nothing is shown, as if none ran.
    }
  }

  async confirm(): Promise<void> {
    if (!this.waits || !this.step || !this.vehicle) return;
    const { run } = this;
    this.confirmed = keyOf(this.step);
    const command = this.machine?.confirm();
    try {
      if (command) {
        this.readMachine();
        await this.vehicle.sendCommand(command.command, command.params);
      } else if (!this.machine) await api.post(this.path('/confirm'));
    } catch (error) {
      if (run !== this.run) return;
      this.confirmed = null;
      toastError(error);
    }
  }

  async cancel(): Promise<void> {
    const { vehicle, kind, run } = this;
    if (!vehicle || !kind || !this.isRunning || this.isCancelling) return;
    this.isCancelling = true;
    try {
      const isCancelled = await this.sendCancel(vehicle, kind);
      if (run !== this.run) return;
      if (!isCancelled) this.reasons = [t('setup.cannotCancel')];
      this.finish('cancelled');
    } catch (error) {
      // It may go on, even with motors that turn, so it is not shown as cancelled.
      if (run === this.run) this.fail([t('setup.cancelFailed', { reason: textOf(error) })]);
    } finally {
      if (run === this.run) this.isCancelling = false;
    }
  }

  reset(): void {
    this.close();
    this.run += 1;
    [this.kind, this.state, this.step, this.reasons, this.outcome] = [null, null, null, [], null];
    [this.vehicle, this.confirmed, this.task, this.isCancelling] = [null, null, null, false];
  }

  private begin(vehicle: Vehicle, kind: string): number {
    this.reset();
    [this.vehicle, this.kind, this.state] = [vehicle, kind, 'running'];
    return this.run;
  }

  private path(rest = ''): string {
    return `vehicles/${this.vehicle!.system}/calibrations/${this.kind!}${rest}`;
  }

  /** Resolves to whether the vehicle can cancel the calibration. */
  private async sendCancel(vehicle: Vehicle, kind: string): Promise<boolean> {
    if (this.machine) {
      const command = cancelCommand(this.machine.firmware, kind);
      if (command) await vehicle.sendCommand(command.command, command.params);
      return command !== null;
    }
    // A task whose start is not answered yet is removed then.
    if (status.source === 'server' && this.task === null) return true;
    return (await api.delete<{ cancelled: boolean }>(this.path())).cancelled;
  }

  private async startTask(vehicle: Vehicle, kind: string, run: number): Promise<void> {
    const { task } = await api.post<{ task: string }>(
      `vehicles/${vehicle.system}/calibrations/${kind}`,
      {},
      { wait: false },
    );
    if (run === this.run && this.isRunning) this.follow(task, run);
    else await api.delete(`tasks/${task}`);
  }

  private follow(task: string, run: number): void {
    this.task = task;
    const events = new EventSource(api.url(`tasks/${task}/progress`));
    this.end = () => events.close();
    const take = (event: MessageEvent<string>): void => {
      const { state, step, error } = JSON.parse(event.data) as TaskEvent;
      if (step) this.takeStep(step);
      if (state === 'done') void this.takeOutcome(task, run);
      // The answer to the cancellation tells how it ended.
      else if (state !== 'running' && !this.isCancelling)
        this.fail([error?.text ?? t('setup.calibration_cancelled'), ...(error?.status_texts ?? [])]);
    };
    for (const name of ['progress', 'done', 'failed', 'cancelled']) events.addEventListener(name, take);
    events.onerror = () => {
      if (events.readyState === EventSource.CLOSED && this.isRunning) this.fail([t('setup.contactLost')]);
    };
  }

  private async takeOutcome(task: string, run: number): Promise<void> {
    this.close();
    const outcome = await api.get<Outcome>(`tasks/${task}/result`).catch(() => null);
    if (run !== this.run) return;
    this.outcome = outcome;
    if (outcome?.reboot_needed && this.vehicle) parameterSet.requireReboot(this.vehicle);
    this.finish('done');
  }

  private async startMachine(vehicle: Vehicle, kind: string, run: number): Promise<void> {
    const { firmware } = vehicle.state;
    const command = startCommand(firmware, kind);
    if (!command) throw new Error(t('setup.noCalibration'));
    const machine = new CalibrationMachine(firmware, kind);
    this.machine = machine;
    const ends = [
      ...['COMMAND_LONG', 'MAG_CAL_PROGRESS', 'MAG_CAL_REPORT'].map((name) =>
        vehicle.onMessage(name, (message) => {
          machine.message(name, message.fields);
          this.readMachine();
        }),
      ),
      vehicle.onStatusText(({ text }) => {
        machine.text(text);
        this.readMachine();
      }),
      vehicle.onState(({ alive }) => {
        if (!alive) this.fail([t('setup.vehicleLost')]);
      }),
    ];
    this.end = () => ends.forEach((each) => each());
    this.readMachine();
    await vehicle.sendCommand(command.command, command.params);
    machine.accepted();
    if (run === this.run) this.readMachine();
  }

  private readMachine(): void {
    if (!this.machine || !this.isRunning) return;
    const { state, step, reason } = this.machine.state;
    this.takeStep(step);
    if (state === 'failed') this.fail([reason]);
    else if (state === 'done') {
      // The station reads what a calibration has changed; here the page does.
      if (parameterSet.vehicle === this.vehicle && !parameterSet.isEmpty) void parameterSet.load();
      this.finish('done');
    }
  }

  private takeStep(step: CalibrationStep): void {
    if (keyOf(step) !== this.confirmed) this.confirmed = null;
    this.step = step;
  }

  private fail(reasons: readonly string[]): void {
    if (!this.isRunning) return;
    const [first = '', ...others] = reasons;
    this.reasons = [first, ...others.filter((each) => !first.includes(each))];
    this.finish('failed');
  }

  private finish(state: RunState): void {
    if (!this.isRunning) return;
    this.close();
    this.state = state;
  }

  private close(): void {
    this.end?.();
    this.end = null;
    this.machine = null;
  }
}

/** Steps of the same key ask for the same: progress alone changes between them. */
function keyOf({ task, pose }: CalibrationStep): string {
  return `${task}/${pose ?? ''}`;
}

function reasonsOf(error: unknown): string[] {
  return [textOf(error), ...(error instanceof StationError ? error.statusTexts : [])];
}

/** A calibration goes on while other views are shown. */
export const calibration = new CalibrationRun();
