/** Commands that the vehicles of the demo carry out, with the reasons of their refusals. */

import type { DecodedMessage } from '$lib/decoder/Decoder';

import { behaviourOf } from './modes';
import type { MockVehicle } from './MockVehicle';

export interface MockCommand {
  readonly command: number;
  readonly params: readonly number[];
  readonly frame: number;
  /** The sender, to whom the acknowledgement goes. */
  readonly system: number;
  readonly component: number;
}

const ACCEPTED = 0;
const TEMPORARILY_REJECTED = 1;
const DENIED = 2;
const UNSUPPORTED = 3;
const FAILED = 4;
const IN_PROGRESS = 5;

const FORCE = 21196;
const REASON_SEVERITY = 2;
const CALIBRATION_TIME = 3000;
const GLOBAL_RELATIVE_ALT = 3;

type Handler = (vehicle: MockVehicle, params: readonly number[], command: MockCommand) => number;

/** Returns the command in a COMMAND_LONG or COMMAND_INT. */
export function commandOf(message: DecodedMessage): MockCommand {
  const { fields, system, component } = message;
  const params = [1, 2, 3, 4].map((index) => Number(fields[`param${index}`]));
  const isInt = message.name === 'COMMAND_INT';
  const place = isInt
    ? [Number(fields.x) / 1e7, Number(fields.y) / 1e7, Number(fields.z)]
    : [fields.param5, fields.param6, fields.param7].map(Number);
  const frame = isInt ? Number(fields.frame) : GLOBAL_RELATIVE_ALT;
  return { command: Number(fields.command), params: [...params, ...place], frame, system, component };
}

/** Carries out a command and acknowledges it. */
export function runCommand(vehicle: MockVehicle, command: MockCommand): void {
  const handler = HANDLERS[command.command];
  const isAllowed = vehicle.isArdupilot || MSP_COMMANDS.has(command.command);
  const result = handler === undefined || !isAllowed ? UNSUPPORTED : handler(vehicle, command.params, command);
  acknowledge(vehicle, command, result);
}

function acknowledge(vehicle: MockVehicle, { command, system, component }: MockCommand, result: number): void {
  vehicle.send('COMMAND_ACK', { command, result, target_system: system, target_component: component });
}

/** Says a reason and returns the result of a refusal. */
function refuse(vehicle: MockVehicle, reason: string | null, result: number = FAILED): number {
  if (reason === null) return ACCEPTED;
  vehicle.say(REASON_SEVERITY, reason);
  return result;
}

function enter(vehicle: MockVehicle, ...names: string[]): number {
  const name = names.find((each) => vehicle.autopilot.modes[each] !== undefined);
  if (name === undefined) return UNSUPPORTED;
  vehicle.autopilot.enter(name);
  return ACCEPTED;
}

const HANDLERS: Readonly<Record<number, Handler>> = {
  // COMPONENT_ARM_DISARM
  400(vehicle, [arm, force]) {
    const isForced = force === FORCE;
    const { autopilot } = vehicle;
    return refuse(vehicle, arm === 1 ? autopilot.arm(isForced) : autopilot.disarm(isForced));
  },
  // NAV_TAKEOFF and NAV_VTOL_TAKEOFF
  22: (vehicle, params) =>
    // As ArduPlane, which takes it in missions only: its pilots take off in the mode TAKEOFF.
    vehicle.autopilot.type === 'plane' ? FAILED : refuse(vehicle, vehicle.autopilot.takeoff(params[6] ?? 10)),
  84: (vehicle, params) => refuse(vehicle, vehicle.autopilot.takeoff(params[6] ?? 10)),
  // DO_SET_MODE
  176(vehicle, params) {
    const { modes } = vehicle.autopilot;
    if (!Object.values(modes).includes(params[1] ?? -1)) return refuse(vehicle, 'Mode change failed: no such mode');
    vehicle.setMode(params[1]!);
    return ACCEPTED;
  },
  20: (vehicle) => enter(vehicle, 'RTL', 'SURFACE'),
  21: (vehicle) => enter(vehicle, 'LAND', 'QLAND', 'SURFACE', 'HOLD'),
  // DO_REPOSITION
  192(vehicle, params, { frame }) {
    const { autopilot } = vehicle;
    if (!autopilot.armed) return refuse(vehicle, 'Guided: vehicle is not armed', TEMPORARILY_REJECTED);
    enter(vehicle, 'GUIDED');
    if (params[0]! > 0) autopilot.setSpeed(params[0]!);
    const radius = params[2]! > 0 ? params[2]! * (params[3] === 1 ? -1 : 1) : undefined;
    autopilot.goto(vehicle.pointOf(frame, params[4]!, params[5]!, params[6]!), radius);
    return ACCEPTED;
  },
  // DO_CHANGE_SPEED
  178(vehicle, params) {
    if (!(params[1]! > 0)) return DENIED;
    vehicle.autopilot.setSpeed(params[1]!);
    return ACCEPTED;
  },
  // DO_CHANGE_ALTITUDE
  186(vehicle, params) {
    const { autopilot } = vehicle;
    const { north, east } = autopilot.motion;
    return autopilot.goto({ north, east, up: params[0]! }) ? ACCEPTED : refuse(vehicle, 'Altitude: not in guided mode');
  },
  // MISSION_START
  300(vehicle) {
    const { autopilot } = vehicle;
    if (autopilot.mission.length < 2) return refuse(vehicle, 'Mission: no mission');
    if (!autopilot.armed) return refuse(vehicle, 'Auto: vehicle is not armed');
    autopilot.start(1);
    return enter(vehicle, 'AUTO');
  },
  // DO_SET_MISSION_CURRENT
  224(vehicle, params) {
    if (params[0]! >= vehicle.autopilot.mission.length) return DENIED;
    vehicle.autopilot.start(params[0]!);
    return ACCEPTED;
  },
  // REQUEST_MESSAGE, SET_MESSAGE_INTERVAL
  512: (vehicle, params) => (vehicle.sendRequested(params[0]!) ? ACCEPTED : DENIED),
  511: () => ACCEPTED,
  // PREFLIGHT_CALIBRATION
  241(vehicle, _params, command) {
    if (vehicle.autopilot.armed) return refuse(vehicle, 'Disarm to allow calibration', TEMPORARILY_REJECTED);
    vehicle.say(6, 'Calibrating');
    setTimeout(() => {
      vehicle.say(6, 'Calibration successful');
      acknowledge(vehicle, command, ACCEPTED);
    }, CALIBRATION_TIME);
    return IN_PROGRESS;
  },
  // PREFLIGHT_REBOOT_SHUTDOWN
  246(vehicle) {
    if (vehicle.autopilot.armed) return refuse(vehicle, 'Reboot refused: vehicle is armed');
    vehicle.say(6, 'Rebooting');
    return ACCEPTED;
  },
  // DO_MOTOR_TEST
  209: (vehicle) => (vehicle.autopilot.armed ? refuse(vehicle, 'Motor Test: vehicle is armed') : ACCEPTED),
  // DO_SET_HOME
  179(vehicle, params, { frame }) {
    const { autopilot } = vehicle;
    const { north, east } = autopilot.motion;
    autopilot.home =
      params[0] === 1 ? { north, east, up: 0 } : vehicle.pointOf(frame, params[4]!, params[5]!, params[6]!);
    vehicle.sendRequested(242);
    return ACCEPTED;
  },
  // DO_SET_ROI_LOCATION, DO_SET_ROI_NONE
  195(vehicle, params, { frame }) {
    vehicle.autopilot.lookedAt = vehicle.pointOf(frame, params[4]!, params[5]!, params[6]!);
    return ACCEPTED;
  },
  197(vehicle) {
    vehicle.autopilot.lookedAt = null;
    return ACCEPTED;
  },
  // DO_PAUSE_CONTINUE
  193(vehicle, params) {
    if (params[0] === 1) return enter(vehicle, 'AUTO');
    return behaviourOf(vehicle.autopilot.mode) === 'mission' ? enter(vehicle, 'LOITER', 'HOLD') : DENIED;
  },
};

/** Commands that a flight controller behind an MSP bridge takes. */
const MSP_COMMANDS: ReadonlySet<number> = new Set([511, 512, 246]);
