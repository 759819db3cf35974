/**
 * Calibrations by the protocol in the page, for vehicles without the station's server.
 *
 * A machine takes the messages and status texts of the vehicle and returns the step for the person at it. Behind
 * the server the calibrations of `mavstack.vehicle` run, whose steps have this form too.
 */

import { AccelcalVehiclePos, MagCalStatus, MavCmd } from '$generated';

export interface CalibrationStep {
  readonly task: string;
  readonly text: string;
  readonly pose: string | null;
  readonly pending: readonly string[];
  /** Percent; null: not known. */
  readonly progress: number | null;
  readonly needs_confirmation: boolean;
}

export type CalibrationState = 'running' | 'done' | 'failed';
export type Firmware = 'ardupilot' | 'px4' | 'msp' | 'other';
export type Params = readonly number[];

export interface MachineState {
  readonly state: CalibrationState;
  readonly step: CalibrationStep;
  /** The reason of a failure. */
  readonly reason: string;
}

type Fields = Readonly<Record<string, unknown>>;

const PREFLIGHT = 'PREFLIGHT_CALIBRATION';
const ARDUPILOT: Readonly<Record<string, Params>> = {
  gyroscope: [1],
  barometer: [0, 0, 1],
  airspeed: [0, 0, 1],
  accelerometer: [0, 0, 0, 0, 1],
  level: [0, 0, 0, 0, 2],
};
const PX4: Readonly<Record<string, Params>> = {
  gyroscope: [1],
  compass: [0, 1],
  barometer: [0, 0, 1],
  accelerometer: [0, 0, 0, 0, 1],
  level: [0, 0, 0, 0, 2],
  airspeed: [0, 0, 0, 0, 0, 1],
  esc: [0, 0, 0, 0, 0, 0, 1],
};
/** MavCmd.ACCELCAL_VEHICLE_POS. */
const POSES: Readonly<Record<number, string>> = {
  [AccelcalVehiclePos.LEVEL]: 'level',
  [AccelcalVehiclePos.LEFT]: 'on its left side',
  [AccelcalVehiclePos.RIGHT]: 'on its right side',
  [AccelcalVehiclePos.NOSEDOWN]: 'nose down',
  [AccelcalVehiclePos.NOSEUP]: 'nose up',
  [AccelcalVehiclePos.BACK]: 'on its back',
};
/** PX4 names a side by the end of the vehicle that is down, except "up": upside down. */
const PX4_POSES: Readonly<Record<string, string>> = {
  down: 'level',
  left: 'on its left side',
  right: 'on its right side',
  front: 'nose down',
  back: 'nose up',
  up: 'on its back',
};
const IDLE: CalibrationStep = {
  task: 'wait',
  text: '',
  pose: null,
  pending: [],
  progress: null,
  needs_confirmation: false,
};

/** Returns the command that starts a calibration; null if the firmware has none in the page. */
export function startCommand(firmware: Firmware, kind: string): { command: string; params: Params } | null {
  if (firmware === 'ardupilot' && kind === 'compass') return { command: 'DO_START_MAG_CAL', params: [0, 1, 1] };
  const params = (firmware === 'px4' ? PX4 : firmware === 'ardupilot' ? ARDUPILOT : {})[kind];
  return params ? { command: PREFLIGHT, params } : null;
}

/** Returns the command that cancels a calibration; null if the firmware has none. */
export function cancelCommand(firmware: Firmware, kind: string): { command: string; params: Params } | null {
  if (firmware === 'px4') return { command: PREFLIGHT, params: [0, 0, 0, 0, 0, 0, 0] };
  return firmware === 'ardupilot' && kind === 'compass' ? { command: 'DO_CANCEL_MAG_CAL', params: [0] } : null;
}

/** Returns the kinds that the page can run itself. */
export function kindsOf(firmware: Firmware): string[] {
  if (firmware === 'px4') return Object.keys(PX4);
  return firmware === 'ardupilot' ? ['compass', ...Object.keys(ARDUPILOT)] : [];
}

/** The order in which a vehicle is set up. */
const ORDER = [
  'accelerometer',
  'level',
  'gyroscope',
  'compass',
  'radio',
  'airspeed',
  'barometer',
  'esc',
  'compass-motor',
];

/** Returns kinds in the order in which a vehicle is set up, for every firmware. */
export function inOrder(kinds: readonly string[]): string[] {
  const place = (kind: string): number => (ORDER.indexOf(kind) + ORDER.length + 1) % (ORDER.length + 1);
  return [...kinds].sort((one, other) => place(one) - place(other));
}

export type PoseState = 'now' | 'pending' | 'done';

/** Returns how far a pose is; ArduPilot asks for the poses in their order, PX4 names those that are left. */
export function stateOfPose(step: CalibrationStep, pose: string, order: readonly string[]): PoseState {
  if (step.pose === pose) return 'now';
  if (step.pending.length) return step.pending.includes(pose) ? 'pending' : 'done';
  return step.pose !== null && order.indexOf(pose) < order.indexOf(step.pose) ? 'done' : 'pending';
}

export class CalibrationMachine {
  readonly firmware: Firmware;
  readonly kind: string;
  state: MachineState = { state: 'running', step: IDLE, reason: '' };
  private readonly compasses = new Map<number, number>();
  private readonly reports = new Map<number, boolean>();
  private position = 0;

  constructor(firmware: Firmware, kind: string) {
    this.firmware = firmware;
    this.kind = kind;
    this.show({ task: 'hold still', text: 'Hold the vehicle still.' });
  }

  /** The vehicle has acknowledged the command: simple calibrations of ArduPilot are done then. */
  accepted(): void {
    const continues = this.firmware !== 'ardupilot' || ['accelerometer', 'compass'].includes(this.kind);
    if (!continues) this.end('done');
  }

  failed(reason: string): void {
    this.end('failed', reason);
  }

  /** Returns the command that confirms a pose; null if nothing waits for one. */
  confirm(): { command: number; params: Params } | null {
    if (!this.state.step.needs_confirmation) return null;
    this.show({ ...this.state.step, task: 'hold still', text: 'Hold the vehicle still.', needs_confirmation: false });
    return { command: MavCmd.ACCELCAL_VEHICLE_POS, params: [this.position] };
  }

  message(name: string, fields: Fields): void {
    if (this.state.state !== 'running') return;
    if (name === 'COMMAND_LONG' && Number(fields.command) === MavCmd.ACCELCAL_VEHICLE_POS)
      this.takePose(Number(fields.param1));
    if (name === 'MAG_CAL_PROGRESS') this.takeCompass(Number(fields.compass_id), Number(fields.completion_pct));
    if (name === 'MAG_CAL_REPORT') this.takeReport(Number(fields.compass_id), Number(fields.cal_status));
  }

  text(text: string): void {
    if (this.firmware !== 'px4' || this.state.state !== 'running' || !text.startsWith('[cal] ')) return;
    const words = text.slice(6).trim();
    const progress = /progress <(\d+)>/.exec(words);
    const pending = /^pending:(.*)/.exec(words);
    const side = /^(\w+) orientation detected/.exec(words);
    if (words.startsWith('calibration done')) this.end('done');
    else if (words.startsWith('calibration failed')) this.end('failed', words.replace(/^calibration failed:?\s*/, ''));
    else if (words.startsWith('calibration cancelled')) this.end('failed', 'it was cancelled');
    else if (progress) this.show({ progress: Number(progress[1]) });
    else if (pending) this.showPending(pending[1]!);
    else if (side)
      this.show({
        task: this.kind === 'compass' ? 'rotate' : 'hold still',
        pose: PX4_POSES[side[1]!] ?? null,
        text: words,
      });
    else if (!words.startsWith('calibration started')) this.show({ text: words });
  }

  private showPending(names: string): void {
    const pending = names
      .trim()
      .split(/\s+/)
      .map((name) => PX4_POSES[name])
      .filter((pose) => pose !== undefined);
    this.show({ task: 'place', pose: null, pending, text: 'Place the vehicle in one of the poses that are left.' });
  }

  private takePose(position: number): void {
    if (this.kind !== 'accelerometer') return;
    const pose = POSES[position];
    // The vehicle repeats its request, and the result of an earlier calibration until it requests a pose.
    if (pose && position !== this.position) {
      this.position = position;
      const progress = Math.round(((position - 1) * 100) / 6);
      this.show({
        task: 'place',
        pose,
        progress,
        text: `Place the vehicle ${pose}, hold it still, and confirm.`,
        needs_confirmation: true,
      });
    } else if (!pose && this.position > 0) {
      if (position === AccelcalVehiclePos.SUCCESS) this.end('done');
      else this.end('failed', 'the vehicle could not calibrate from these poses');
    }
  }

  private takeCompass(compass: number, percent: number): void {
    if (this.kind !== 'compass') return;
    this.compasses.set(compass, percent);
    const text = 'Turn the vehicle slowly around all its axes.';
    this.show({ task: 'rotate', text, progress: Math.min(...this.compasses.values()) });
  }

  private takeReport(compass: number, status: number): void {
    if (this.kind !== 'compass') return;
    this.reports.set(compass, status === MagCalStatus.SUCCESS);
    if (![...this.compasses.keys()].every((each) => this.reports.has(each))) return;
    if ([...this.reports.values()].every(Boolean)) this.end('done');
    else this.end('failed', 'a compass could not be calibrated: keep away from metal, and turn around all axes');
  }

  private show(changed: Partial<CalibrationStep>): void {
    this.state = { ...this.state, step: { ...this.state.step, ...changed } };
  }

  private end(state: CalibrationState, reason = ''): void {
    this.state = { ...this.state, state, reason };
  }
}
