/** A vehicle that the page itself talks to by MAVLink: over USB, or in the demo. */

import { AutopilotVersion, HomePosition, MavFrame, MavModeFlag, MavProtocolCapability, MavResult } from '$generated';
import { StationError } from '$lib/api/errors';
import type { ActionFields, ActionName } from '$lib/api/requests';
import type { DecodedMessage } from '$lib/decoder/Decoder';
import { distance } from '$lib/map/geometry';

import { EQUIPMENT_PARAMETERS, capabilitiesFrom, equipmentOf, type Equipment } from './capabilities';
import { checkRadius, circle, type CircleSteps } from './link/circle';
import { ConflictDetector, ONE_LINK } from './link/conflict';
import { commandNumber, sendCommand, type CommandPlace } from './link/commands';
import * as flight from './link/flight';
import type { FlightFacts, FlightSteps } from './link/flight';
import { equipmentCommand } from './link/equipment';
import { holdMode, landMode, modeNumbers, NOT_SELECTABLE, RETURN_MODES } from './link/modes';
import { PendingCommands } from './link/pending';
import { encodingOf, type ParameterEncoding } from './link/parameterValue';
import { readParameter, readParameters, writeParameter } from './link/parameters';
import { aboveSea, homeAltitude, placeOf } from './link/places';
import { PlanClient } from './link/plans';
import { TelemetryRequests } from './link/telemetry';
import { sequenceOf } from './missionItem';
import { ObservedVehicle, type Send } from './ObservedVehicle.svelte';
import type {
  CommandResult,
  Mode,
  OrbitOptions,
  Parameter,
  Plan,
  PlanKind,
  ProgressListener,
  StatusText,
  Target,
  Vehicle,
} from './Vehicle';

const DEFAULT_RADIUS = 20;
const VERSION_DELAY = 500;

/** Parameter by which ArduPilot tells a quadplane, which calls itself a plane. */
const QUADPLANE_PARAMETER = 'Q_ENABLE';

export class LinkVehicle extends ObservedVehicle implements Vehicle {
  private flags: bigint | null = null;
  private equipment: Equipment = {};
  private readonly timer: ReturnType<typeof setTimeout>;
  private readonly pending = new PendingCommands();
  private readonly telemetry = new TelemetryRequests(this);
  private readonly detector = new ConflictDetector();
  /** The number of its throttle channel. */
  private throttleChannel = 3;
  /** Whether an ArduPilot plane is a quadplane; null: not known. */
  private quadplane: boolean | null = null;

  constructor(heartbeat: DecodedMessage, send: Send) {
    super(heartbeat, send);
    this.timer = setTimeout(() => this.requestFacts(), VERSION_DELAY);
    this.telemetry.start();
    this.updateCapabilities();
  }

  override dispose(): void {
    clearTimeout(this.timer);
    this.telemetry.end();
    this.pending.end();
    super.dispose();
  }

  override take(message: DecodedMessage): StatusText | null {
    const text = super.take(message);
    if (message.component === this.component) {
      this.telemetry.take(message.name);
      this.detector.take(message);
      const conflict = this.detector.conflict(message.time);
      if (conflict !== this.conflict) this.setConflict(conflict);
    }
    if (message.name === 'AUTOPILOT_VERSION' && message.component === this.component) {
      this.flags = BigInt(message.fields.capabilities as number | bigint);
      this.updateCapabilities();
    }
    if (message.name === 'PARAM_VALUE') this.takeEquipment(message);
    return text;
  }

  private takeEquipment({ fields, component }: DecodedMessage): void {
    if (component !== this.component) return;
    if (fields.param_id === 'RCMAP_THROTTLE') this.throttleChannel = Number(fields.param_value);
    if (fields.param_id === QUADPLANE_PARAMETER) this.quadplane = Number(fields.param_value) !== 0;
    const found = equipmentOf(String(fields.param_id), Number(fields.param_value));
    if (found === null) return;
    this.equipment = { ...this.equipment, ...found };
    this.updateCapabilities();
  }

  getParameter(name: string): Promise<Parameter> {
    return readParameter(this, name, this.encoding);
  }

  getParameters(onProgress?: ProgressListener): Promise<Parameter[]> {
    return readParameters(this, this.encoding, onProgress);
  }

  async setParameter(name: string, value: number): Promise<Parameter> {
    this.refuseInConflict(`setting ${name} of`);
    return writeParameter(this, name, value, this.encoding);
  }

  async sendCommand(command: string | number, params: readonly (number | null)[] = []): Promise<CommandResult> {
    return this.transmit(`command ${command}`, command, params);
  }

  arm(force = false): Promise<void> {
    return flight.armFirst(this.steps('arming', this.pending.startAction()), { force });
  }

  disarm(force = false): Promise<void> {
    return this.act('disarming', 'COMPONENT_ARM_DISARM', [0, force ? flight.FORCE : 0]);
  }

  async takeoff(altitude: number): Promise<void> {
    if (!(altitude > 0 && Number.isFinite(altitude))) {
      throw new StationError('InvalidArgumentError', `takeoff altitude must be positive and finite, got ${altitude}`);
    }
    const steps = this.flightSteps('taking off');
    if (await this.isFixedWing()) return flight.takeOffInMode(steps, altitude);
    const height = this.state.firmware === 'px4' ? aboveSea(steps, altitude) : altitude;
    await flight.orRestoreMode(steps, async () => {
      if (this.state.firmware === 'ardupilot') await steps.enter(['GUIDED']);
      await steps.send('NAV_TAKEOFF', [0, 0, 0, null, null, null, height]);
    });
  }

  private facts(operation: string): FlightFacts {
    return {
      state: this.state,
      failure: (reason, kind = 'InvalidStateError') => this.failure(kind, operation, reason),
    };
  }

  /** Returns the steps of an action that flies the vehicle, unless it cannot do that now; nothing is sent for it. */
  private flightSteps(operation: string, needsAir = false): FlightSteps {
    this.refuseInConflict(operation);
    const signal = this.pending.startAction(); // ends an arming that is under way also where this is refused
    const reason = flight.reasonAgainstFlight(this.state, needsAir);
    if (reason !== null) throw this.failure('ActionRefused', operation, reason);
    return this.steps(operation, signal);
  }

  private steps(operation: string, signal: AbortSignal): FlightSteps {
    return flight.noteModes({
      ...this.facts(operation),
      signal,
      entered: false,
      enter: (modes) => this.enter(operation, modes, signal),
      send: (command, params) => this.transmit(operation, command, params, undefined, signal),
      getParameter: (name) => this.getParameter(name),
      setParameter: (name, value) => this.setParameter(name, value),
    });
  }

  async land(): Promise<void> {
    const steps = this.flightSteps('landing');
    const { firmware, type } = this.state;
    if (await this.isFixedWing()) return flight.landByMission(steps);
    await steps.enter([landMode(firmware, firmware === 'ardupilot' && type === 'plane' ? 'vtol' : type)]);
  }

  async rtl(): Promise<void> {
    await this.flightSteps('returning').enter(RETURN_MODES);
  }

  async hold(): Promise<void> {
    await this.flightSteps('holding').enter([this.holdMode]);
  }

  async goto(target: Target, altitude?: number): Promise<void> {
    const operation = 'going to a position with';
    const place = placeOf(this.facts(operation), target, altitude);
    const { signal } = this.flightSteps(operation, true);
    await this.transmit(operation, 'DO_REPOSITION', [-1, 1, 0, null], place, signal);
  }

  async orbit({ center, altitude, radius = DEFAULT_RADIUS, speed }: OrbitOptions): Promise<void> {
    const operation = 'orbiting with';
    if (this.capabilities.orbit === false)
      throw this.failure('ActionUnsupported', operation, 'the vehicle has no command for it');
    checkRadius(radius);
    const place = placeOf(this.facts(operation), center, altitude);
    const steps = this.flightSteps(operation, true);
    if (this.state.firmware === 'ardupilot') {
      return flight.orRestoreMode(steps, () => circle(this.circleSteps(operation, place, steps), radius, speed));
    }
    await this.transmit(operation, 'DO_ORBIT', [radius, speed ?? null, 0, 0], place, steps.signal);
  }

  private circleSteps(operation: string, place: CommandPlace, steps: FlightSteps): CircleSteps {
    return {
      ...steps,
      operation: `${operation} ${this.system}/${this.component}`,
      isWing: this.state.type === 'plane' || this.state.type === 'vtol',
      goToCenter: (radius, direction) =>
        this.transmit(operation, 'DO_REPOSITION', [-1, 1, radius, direction], place, steps.signal),
      throttle: () => this.state.rc?.channels[this.throttleChannel - 1] ?? null,
      distance: () => (this.state.position === null ? null : distance(this.state.position, place)),
    };
  }

  async lookAt(target: Target | null, altitude = 0): Promise<void> {
    const operation = 'setting the region of interest of';
    if (target === null) return this.lookAhead(operation);
    const place =
      this.state.firmware === 'px4'
        ? { ...target, frame: MavFrame.GLOBAL, altitude: homeAltitude(this.facts(operation)) + altitude }
        : placeOf(this.facts(operation), target, altitude);
    await this.transmit(operation, 'DO_SET_ROI_LOCATION', [], place);
  }

  async setHome(target: Target): Promise<void> {
    const operation = 'setting the home position of';
    const place = { ...target, frame: MavFrame.GLOBAL, altitude: homeAltitude(this.facts(operation)) };
    await this.transmit(operation, 'DO_SET_HOME', [0, 0, 0, null], place);
    this.requestMessage(HomePosition.info.id);
  }

  async setSpeed(speed: number): Promise<void> {
    await this.transmit('changing the speed of', 'DO_CHANGE_SPEED', [1, speed, -1]);
  }

  async setAltitude(altitude: number): Promise<void> {
    const position = this.state.position;
    if (position === null) throw this.failure('InvalidStateError', 'changing the altitude of', 'no position yet');
    await this.goto(position, altitude);
  }

  setMode(name: string): Promise<void> {
    return this.enter(`changing to ${name}`, [name]);
  }

  modes(): Promise<Mode[]> {
    const modes = Object.entries(modeNumbers(this.state));
    return Promise.resolve(
      modes.map(([name, number]) => ({ name, number, selectable: !NOT_SELECTABLE.has(name), advanced: false })),
    );
  }

  async startMission(arm = false): Promise<void> {
    this.refuseInConflict('starting the mission of');
    await flight.startMission(this.steps('starting the mission of', this.pending.startAction()), arm);
  }

  async pauseMission(): Promise<void> {
    await this.flightSteps('pausing the mission of').enter([this.holdMode]);
  }

  async setMissionItem(number: number): Promise<void> {
    const seq = sequenceOf(number, this.state.firmware);
    await this.transmit('choosing the mission item of', 'DO_SET_MISSION_CURRENT', [seq]);
  }

  reboot(): Promise<void> {
    return this.act('rebooting', 'PREFLIGHT_REBOOT_SHUTDOWN', [1]);
  }

  async perform<Name extends ActionName>(action: Name, fields: ActionFields<Name>): Promise<void> {
    const found = equipmentCommand(action, fields);
    if (found === null) throw this.failure('ActionUnsupported', action, 'it needs the station');
    await this.transmit(`${action} on`, found.command, found.params);
  }

  downloadPlan(kind: PlanKind, onProgress?: ProgressListener): Promise<Plan> {
    return new PlanClient(this, this.hasHomeItem).download(kind, onProgress);
  }

  async uploadPlan(kind: PlanKind, plan: Plan, onProgress?: ProgressListener): Promise<void> {
    this.refuseInConflict(`uploading the ${kind} to`);
    return new PlanClient(this, this.hasHomeItem).upload(kind, plan, onProgress);
  }

  async clearPlan(kind: PlanKind): Promise<void> {
    this.refuseInConflict(`clearing the ${kind} of`);
    return new PlanClient(this, this.hasHomeItem).clear(kind);
  }

  chooseSender(): Promise<void> {
    return Promise.reject(this.failure('ActionUnsupported', 'choosing the sender of', ONE_LINK));
  }

  renumber(): Promise<number> {
    return Promise.reject(this.failure('ActionUnsupported', 'renumbering', ONE_LINK));
  }

  private get holdMode(): string {
    return holdMode(this.state.firmware, this.state.type);
  }

  /** Whether it is a plane of ArduPilot that cannot hover. */
  private async isFixedWing(): Promise<boolean> {
    const { firmware, type, vtolState } = this.state;
    if (firmware !== 'ardupilot' || type !== 'plane') return false;
    if (vtolState === null && this.quadplane === null) {
      await this.getParameter(QUADPLANE_PARAMETER).catch(() => (this.quadplane = false));
    }
    return vtolState === null && this.quadplane !== true;
  }

  private get encoding(): ParameterEncoding {
    if (this.flags === null) return encodingOf(this.state.firmware) ?? 'cast';
    return (this.flags & MavProtocolCapability.PARAM_ENCODE_BYTEWISE) !== 0n ? 'bytewise' : 'cast';
  }

  private get hasHomeItem(): boolean {
    return this.state.firmware === 'ardupilot';
  }

  private requestFacts(): void {
    for (const id of [AutopilotVersion.info.id, HomePosition.info.id]) this.requestMessage(id);
  }

  private requestMessage(id: number): void {
    this.sendMessage('COMMAND_LONG', { command: commandNumber('REQUEST_MESSAGE'), param1: id });
  }

  private requestEquipment(): void {
    for (const name of Object.keys(EQUIPMENT_PARAMETERS)) {
      this.sendMessage('PARAM_REQUEST_READ', { param_id: name, param_index: -1 });
    }
  }

  private updateCapabilities(): void {
    const { firmware, type } = this.state;
    this.currentCapabilities = capabilitiesFrom(firmware, type, this.flags, this.equipment);
  }

  override publish(now: number): void {
    const before = this.state.firmware;
    super.publish(now);
    if (this.state.firmware === before) return;
    this.updateCapabilities();
    if (this.state.firmware === 'msp') this.requestEquipment();
  }

  private failure(kind: string, operation: string, reason: string): StationError {
    return new StationError(kind, `${operation} ${this.system}/${this.component} failed: ${reason}`);
  }

  /** Points ahead again; ArduPilot before 4.2 takes a place of zeros for it. */
  private async lookAhead(operation: string): Promise<void> {
    try {
      await this.transmit(operation, 'DO_SET_ROI_NONE', []);
    } catch (error) {
      if (
        !(error instanceof StationError) ||
        error.code !== MavResult.UNSUPPORTED ||
        this.state.firmware !== 'ardupilot'
      )
        throw error;
      const place = { latitude: 0, longitude: 0, altitude: 0, frame: MavFrame.GLOBAL_RELATIVE_ALT_INT };
      await this.transmit(operation, 'DO_SET_ROI_LOCATION', [], place);
    }
  }

  /** Sends the command of an action of the pilot, which replaces an earlier one. */
  private async act(
    operation: string,
    command: string,
    params: readonly (number | null)[],
    place?: CommandPlace,
  ): Promise<void> {
    await this.transmit(operation, command, params, place, this.pending.startAction());
  }

  private async transmit(
    operation: string,
    command: string | number,
    params: readonly (number | null)[],
    place?: CommandPlace,
    action?: AbortSignal,
  ): Promise<CommandResult> {
    this.refuseInConflict(operation);
    return this.pending.run(commandNumber(command), params, action, (signal) =>
      sendCommand(this, operation, command, params, place, signal),
    );
  }

  private async enter(
    operation: string,
    names: readonly string[],
    action: AbortSignal = this.pending.startAction(),
  ): Promise<void> {
    const modes = modeNumbers(this.state);
    const number = names.map((name) => modes[name]).find((value) => value !== undefined);
    if (number === undefined) {
      throw this.failure('ActionUnsupported', operation, `the vehicle has no mode ${names.join(' or ')}`);
    }
    const main = this.state.firmware === 'px4' ? (number >>> 16) & 0xff : number;
    const sub = this.state.firmware === 'px4' ? number >>> 24 : 0;
    await this.transmit(operation, 'DO_SET_MODE', [MavModeFlag.CUSTOM_MODE_ENABLED, main, sub], undefined, action);
  }
}
