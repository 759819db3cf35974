/**
 * A motor that runs while its button is held.
 *
 * The vehicle gets the command again and again, each for a short time: a motor stops by itself soon after the page,
 * the station or the link is gone. Only the first command is repeated until it is answered, since a repetition of a
 * later one could start the motor after it was stopped.
 */

import { textOf } from '$lib/api/errors';
import { toastError } from '$lib/ui/toasts.svelte';
import type { Vehicle } from '$lib/vehicle/Vehicle';

import { motorCommand, motorMessage } from './logic/motors';

/** Seconds for which the vehicle runs a motor without a further command. */
export const RUN_TIME = 1;
/** Time in ms between two commands. */
const INTERVAL = 350;

export class MotorTest {
  /** The motor whose button is held; null: none. */
  running: number | null = $state(null);
  /** Why the vehicle refused the last test. */
  problem: string | null = $state(null);
  private readonly vehicle: Vehicle;
  private timer: ReturnType<typeof setInterval> | undefined;

  constructor(vehicle: Vehicle) {
    this.vehicle = vehicle;
  }

  /** Runs a motor with a throttle in percent, until `stop`. */
  async start(motor: number, throttle: number): Promise<void> {
    this.stop();
    this.running = motor;
    this.problem = null;
    const { vehicle } = this;
    const { command, params } = motorCommand(vehicle.state.firmware, motor, throttle, RUN_TIME);
    try {
      await vehicle.sendCommand(command, params);
    } catch (error) {
      this.problem = textOf(error);
      if (this.running === motor) this.running = null;
      else toastError(error);
      return;
    }
    // The button was let go before the answer: the command may have been sent again after the one that stops.
    if (this.running !== motor) this.send(motor, 0, 0);
    else this.timer ??= setInterval(() => this.renew(motor, throttle), INTERVAL);
  }

  stop(): void {
    clearInterval(this.timer);
    this.timer = undefined;
    if (this.running === null) return;
    const motor = this.running;
    this.running = null;
    this.send(motor, 0, 0);
  }

  private renew(motor: number, throttle: number): void {
    if (this.vehicle.state.alive) this.send(motor, throttle, RUN_TIME);
    else this.stop();
  }

  private send(motor: number, throttle: number, seconds: number): void {
    const { firmware } = this.vehicle.state;
    this.vehicle.sendMessage('COMMAND_LONG', motorMessage(motorCommand(firmware, motor, throttle, seconds)));
  }
}
