/** A calibration that runs: by the station's server, or by the protocol in the page. */

import { api } from '$lib/api/client';
import { textOf } from '$lib/api/errors';
import { t } from '$lib/i18n';
import { status } from '$lib/store/status.svelte';
import type { Vehicle } from '$lib/vehicle/Vehicle';
import { toastError } from '$lib/ui/toasts.svelte';

import { CalibrationMachine, cancelCommand, kindsOf, startCommand, type CalibrationStep } from './logic/calibration';

export type RunState = 'running' | 'done' | 'failed' | 'cancelled';

interface TaskEvent {
  readonly state: RunState;
  readonly step?: CalibrationStep;
  readonly error?: { readonly text: string; readonly status_texts?: readonly string[] };
}

class CalibrationRun {
  kind: string | null = $state(null);
  state: RunState | null = $state(null);
  step: CalibrationStep | null = $state.raw(null);
  /** Lines about a failure: the reason, then the vehicle's texts. */
  reasons: readonly string[] = $state.raw([]);
  vehicle: Vehicle | null = $state.raw(null);
  private machine: CalibrationMachine | null = null;
  private end: (() => void) | null = null;

  get isRunning(): boolean {
    return this.state === 'running';
  }

  /** The kinds that can be run for a vehicle. */
  kinds(vehicle: Vehicle): readonly string[] {
    return status.source === 'server' ? vehicle.capabilities.calibration : kindsOf(vehicle.state.firmware);
  }

  async start(vehicle: Vehicle, kind: string): Promise<void> {
    if (this.isRunning) return;
    this.reset();
    [this.vehicle, this.kind, this.state] = [vehicle, kind, 'running'];
    try {
      if (status.source === 'server') await this.startTask(vehicle, kind);
      else await this.startMachine(vehicle, kind);
    } catch (error) {
      this.fail([textOf(error)]);
    }
  }

  async confirm(): Promise<void> {
    const command = this.machine?.confirm();
    try {
      if (command && this.vehicle) {
        this.follow();
        await this.vehicle.sendCommand(command.command, command.params);
      } else if (!this.machine) await api.post(this.path('/confirm'));
    } catch (error) {
      toastError(error);
    }
  }

  async cancel(): Promise<void> {
    const { vehicle, kind } = this;
    if (!vehicle || !kind) return;
    try {
      if (this.machine) {
        const { command, params } = cancelCommand(this.machine.firmware, kind);
        await vehicle.sendCommand(command, params);
      } else await api.delete(this.path());
    } catch (error) {
      // It may go on, even with motors that turn, so it is not shown as cancelled.
      this.fail([t('setup.cancelFailed', { reason: textOf(error) })]);
      return;
    }
    this.finish('cancelled');
  }

  reset(): void {
    this.end?.();
    this.end = null;
    this.machine = null;
    [this.kind, this.state, this.step, this.reasons] = [null, null, null, []];
  }

  private path(rest = ''): string {
    return `vehicles/${this.vehicle!.system}/calibrations/${this.kind!}${rest}`;
  }

  private async startTask(vehicle: Vehicle, kind: string): Promise<void> {
    const { task } = await api.post<{ task: string }>(`vehicles/${vehicle.system}/calibrations/${kind}`, {}, { wait: false });
    const events = new EventSource(api.url(`tasks/${task}/progress`));
    this.end = () => events.close();
    const take = (event: MessageEvent<string>): void => {
      const { state, step, error } = JSON.parse(event.data) as TaskEvent;
      if (step) this.step = step;
      if (state === 'failed') this.fail([error?.text ?? '', ...(error?.status_texts ?? [])]);
      else if (state !== 'running') this.finish(state);
    };
    for (const name of ['progress', 'done', 'failed', 'cancelled']) events.addEventListener(name, take);
    events.onerror = () => {
      if (events.readyState === EventSource.CLOSED && this.isRunning) this.fail([t('setup.contactLost')]);
    };
  }

  private async startMachine(vehicle: Vehicle, kind: string): Promise<void> {
    const { firmware } = vehicle.state;
    const command = startCommand(firmware, kind);
    if (!command) throw new Error(t('setup.noCalibration'));
    const machine = new CalibrationMachine(firmware, kind);
    this.machine = machine;
    const ends = [
      ...['COMMAND_LONG', 'MAG_CAL_PROGRESS', 'MAG_CAL_REPORT'].map((name) =>
        vehicle.onMessage(name, (message) => {
          machine.message(name, message.fields);
          this.follow();
        }),
      ),
      vehicle.onStatusText(({ text }) => {
        machine.text(text);
        this.follow();
      }),
    ];
    this.end = () => ends.forEach((each) => each());
    this.follow();
    await vehicle.sendCommand(command.command, command.params);
    machine.accepted();
    this.follow();
  }

  private follow(): void {
    if (!this.machine || !this.isRunning) return;
    const { state, step, reason } = this.machine.state;
    this.step = step;
    if (state === 'failed') this.fail([reason]);
    else if (state === 'done') this.finish('done');
  }

  private fail(reasons: readonly string[]): void {
    const [first = '', ...others] = reasons;
    this.reasons = [first, ...others.filter((each) => !first.includes(each))];
    this.finish('failed');
  }

  private finish(state: RunState): void {
    if (!this.isRunning) return;
    this.end?.();
    this.end = null;
    this.machine = null;
    this.state = state;
  }
}

/** A calibration goes on while other views are shown. */
export const calibration = new CalibrationRun();
