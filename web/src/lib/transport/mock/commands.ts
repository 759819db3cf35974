/** Commands that the vehicles of the demo carry out, with the reasons of their refusals. */

import { HomePosition, MavCmd, MavFrame, MavResult, MavSeverity } from '$generated';
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

const FORCE = 21196;
const REASON_SEVERITY = MavSeverity.CRITICAL;
const CALIBRATION_TIME = 3000;

type Handler = (vehicle: MockVehicle, params: readonly number[], command: MockCommand) => number;

/** Returns the command in a COMMAND_LONG or COMMAND_INT. */
export function commandOf(message: DecodedMessage): MockCommand {
  const { fields, system, component } = message;
  const params = [1, 2, 3, 4].map((index) => Number(fields[`param${index}`]));
  const isInt = message.name === 'COMMAND_INT';
  const place = isInt
    ? [Number(fields.x) / 1e7, Number(fields.y) / 1e7, Number(fields.z)]
    : [fields.param5, fields.param6, fields.param7].map(Number);
  const frame = isInt ? Number(fields.frame) : MavFrame.GLOBAL_RELATIVE_ALT;
  return { command: Number(fields.command), params: [...params, ...place], frame, system, component };
}

/** Carries out a command and acknowledges it. */
export function runCommand(vehicle: MockVehicle, command: MockCommand): void {
  const handler = HANDLERS[command.command];
  const isAllowed = vehicle.isArdupilot || MSP_COMMANDS.has(command.command);
  const result =
    handler === undefined || !isAllowed ? MavResult.UNSUPPORTED : handler(vehicle, command.params, command);
  acknowledge(vehicle, command, result);
}

function acknowledge(vehicle: MockVehicle, { command, system, component }: MockCommand, result: number): void {
  vehicle.send('COMMAND_ACK', { command, result, target_system: system, target_component: component });
}

/** Says a reason and returns the result of a refusal. */
function refuse(vehicle: MockVehicle, reason: string | null, result: number = MavResult.FAILED): number {
  if (reason === null) return MavResult.ACCEPTED;
  vehicle.say(REASON_SEVERITY, reason);
  return result;
}

function enter(vehicle: MockVehicle, ...names: string[]): number {
  const name = names.find((each) => vehicle.autopilot.modes[each] !== undefined);
  if (name === undefined) return MavResult.UNSUPPORTED;
  vehicle.autopilot.enter(name);
  return MavResult.ACCEPTED;
}

const HANDLERS: Readonly<Record<number, Handler>> = {
  [MavCmd.COMPONENT_ARM_DISARM](vehicle, [arm, force]) {
    const isForced = force === FORCE;
    const { autopilot } = vehicle;
    return refuse(vehicle, arm === 1 ? autopilot.arm(isForced) : autopilot.disarm(isForced));
  },
  [MavCmd.NAV_TAKEOFF]: (vehicle, params) =>
    // As ArduPlane, which takes it in missions only: its pilots take off in the mode TAKEOFF.
    vehicle.autopilot.type === 'plane' ? MavResult.FAILED : refuse(vehicle, vehicle.autopilot.takeoff(params[6] ?? 10)),
  [MavCmd.NAV_VTOL_TAKEOFF]: (vehicle, params) => refuse(vehicle, vehicle.autopilot.takeoff(params[6] ?? 10)),
  [MavCmd.DO_SET_MODE](vehicle, params) {
    const { modes } = vehicle.autopilot;
    if (!Object.values(modes).includes(params[1] ?? -1)) return refuse(vehicle, 'Mode change failed: no such mode');
    vehicle.setMode(params[1]!);
    return MavResult.ACCEPTED;
  },
  [MavCmd.NAV_RETURN_TO_LAUNCH]: (vehicle) => enter(vehicle, 'RTL', 'SURFACE'),
  [MavCmd.NAV_LAND]: (vehicle) => enter(vehicle, 'LAND', 'QLAND', 'SURFACE', 'HOLD'),
  [MavCmd.DO_REPOSITION](vehicle, params, { frame }) {
    const { autopilot } = vehicle;
    if (!autopilot.armed) return refuse(vehicle, 'Guided: vehicle is not armed', MavResult.TEMPORARILY_REJECTED);
    enter(vehicle, 'GUIDED');
    if (params[0]! > 0) autopilot.setSpeed(params[0]!);
    const radius = params[2]! > 0 ? params[2]! * (params[3] === 1 ? -1 : 1) : undefined;
    autopilot.goto(vehicle.pointOf(frame, params[4]!, params[5]!, params[6]!), radius);
    return MavResult.ACCEPTED;
  },
  [MavCmd.DO_CHANGE_SPEED](vehicle, params) {
    if (!(params[1]! > 0)) return MavResult.DENIED;
    vehicle.autopilot.setSpeed(params[1]!);
    return MavResult.ACCEPTED;
  },
  [MavCmd.DO_CHANGE_ALTITUDE](vehicle, params) {
    const { autopilot } = vehicle;
    const { north, east } = autopilot.motion;
    return autopilot.goto({ north, east, up: params[0]! })
      ? MavResult.ACCEPTED
      : refuse(vehicle, 'Altitude: not in guided mode');
  },
  [MavCmd.MISSION_START](vehicle) {
    const { autopilot } = vehicle;
    if (autopilot.mission.length < 2) return refuse(vehicle, 'Mission: no mission');
    if (!autopilot.armed) return refuse(vehicle, 'Auto: vehicle is not armed');
    autopilot.start(1);
    return enter(vehicle, 'AUTO');
  },
  [MavCmd.DO_SET_MISSION_CURRENT](vehicle, params) {
    if (params[0]! >= vehicle.autopilot.mission.length) return MavResult.DENIED;
    vehicle.autopilot.start(params[0]!);
    return MavResult.ACCEPTED;
  },
  [MavCmd.REQUEST_MESSAGE]: (vehicle, params) =>
    vehicle.sendRequested(params[0]!) ? MavResult.ACCEPTED : MavResult.DENIED,
  [MavCmd.SET_MESSAGE_INTERVAL]: () => MavResult.ACCEPTED,
  [MavCmd.PREFLIGHT_CALIBRATION](vehicle, _params, command) {
    if (vehicle.autopilot.armed) return refuse(vehicle, 'Disarm to allow calibration', MavResult.TEMPORARILY_REJECTED);
    vehicle.say(MavSeverity.INFO, 'Calibrating');
    setTimeout(() => {
      vehicle.say(MavSeverity.INFO, 'Calibration successful');
      acknowledge(vehicle, command, MavResult.ACCEPTED);
    }, CALIBRATION_TIME);
    return MavResult.IN_PROGRESS;
  },
  [MavCmd.PREFLIGHT_REBOOT_SHUTDOWN](vehicle) {
    if (vehicle.autopilot.armed) return refuse(vehicle, 'Reboot refused: vehicle is armed');
    vehicle.say(MavSeverity.INFO, 'Rebooting');
    return MavResult.ACCEPTED;
  },
  [MavCmd.DO_MOTOR_TEST]: (vehicle) =>
    vehicle.autopilot.armed ? refuse(vehicle, 'Motor Test: vehicle is armed') : MavResult.ACCEPTED,
  [MavCmd.DO_SET_HOME](vehicle, params, { frame }) {
    const { autopilot } = vehicle;
    const { north, east } = autopilot.motion;
    autopilot.home =
      params[0] === 1 ? { north, east, up: 0 } : vehicle.pointOf(frame, params[4]!, params[5]!, params[6]!);
    vehicle.sendRequested(HomePosition.info.id);
    return MavResult.ACCEPTED;
  },
  [MavCmd.DO_SET_ROI_LOCATION](vehicle, params, { frame }) {
    vehicle.autopilot.lookedAt = vehicle.pointOf(frame, params[4]!, params[5]!, params[6]!);
    return MavResult.ACCEPTED;
  },
  [MavCmd.DO_SET_ROI_NONE](vehicle) {
    vehicle.autopilot.lookedAt = null;
    return MavResult.ACCEPTED;
  },
  [MavCmd.DO_PAUSE_CONTINUE](vehicle, params) {
    if (params[0] === 1) return enter(vehicle, 'AUTO');
    return behaviourOf(vehicle.autopilot.mode) === 'mission' ? enter(vehicle, 'LOITER', 'HOLD') : MavResult.DENIED;
  },
};

/** Commands that a flight controller behind an MSP bridge takes. */
const MSP_COMMANDS: ReadonlySet<number> = new Set([
  MavCmd.SET_MESSAGE_INTERVAL,
  MavCmd.REQUEST_MESSAGE,
  MavCmd.PREFLIGHT_REBOOT_SHUTDOWN,
]);
