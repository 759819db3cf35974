/** One vehicle of the demo: the MAVLink component around an autopilot. Time is in ms since the demo began. */

import { MavCmd, MavFrame } from '$generated';
import { Encoder, type DecodedMessage, type SentFields } from '$lib/decoder/Decoder';

import { commandOf, runCommand } from './commands';
import { MockAutopilot } from './MockAutopilot';
import { parametersOf, type MockParameter } from './parameters';
import { toDegrees, toMetres } from './place';
import { MissionServer } from './plans';
import { ARDUPILOT, type MockProfile } from './profiles';
import { Telemetry } from './telemetry';

const POSITION_INTERVAL = 100;
/** Parameters of a list that are sent in each step. */
const PARAMETERS_PER_STEP = 15;

export class MockVehicle {
  readonly autopilot: MockAutopilot;
  readonly parameters: readonly MockParameter[];
  readonly profile: MockProfile;
  private readonly encoder: Encoder;
  private readonly missions: MissionServer;
  private readonly telemetry: Telemetry;
  private readonly transmit: (packet: Uint8Array) => void;
  private listIndex: number | null = null;

  constructor(profile: MockProfile, transmit: (packet: Uint8Array) => void) {
    this.profile = profile;
    this.transmit = transmit;
    this.encoder = new Encoder(profile.system, 1);
    this.autopilot = new MockAutopilot(profile, (severity, text) => this.say(severity, text));
    this.parameters = parametersOf(profile, this.autopilot.type);
    this.missions = new MissionServer(this.autopilot, (name, fields) => this.send(name, fields));
    this.telemetry = new Telemetry(this, (name, fields) => this.send(name, fields));
    this.begin();
  }

  send(name: string, fields: SentFields): void {
    this.transmit(this.encoder.build(name, fields));
  }

  say(severity: number, text: string): void {
    this.send('STATUSTEXT', { severity, text: text.slice(0, 50) });
  }

  step(now: number, dt: number): void {
    this.autopilot.step(dt);
    this.missions.step(dt);
    this.telemetry.step(now);
    for (const seq of this.autopilot.reached.splice(0)) this.send('MISSION_ITEM_REACHED', { seq });
    this.listParameters();
  }

  /** Takes a message of a ground station. */
  receive(message: DecodedMessage): void {
    const { fields } = message;
    if (Number(fields.target_system ?? fields.target ?? 0) !== this.profile.system) return;
    switch (message.name) {
      case 'COMMAND_LONG':
      case 'COMMAND_INT':
        return runCommand(this, commandOf(message));
      case 'SET_MODE':
        return this.setMode(Number(fields.custom_mode));
      case 'PARAM_REQUEST_LIST':
        this.listIndex = 0;
        return;
      case 'PARAM_REQUEST_READ':
        return this.readParameter(String(fields.param_id), Number(fields.param_index));
      case 'PARAM_SET':
        return this.writeParameter(String(fields.param_id), Number(fields.param_value));
      case 'MANUAL_CONTROL':
        return this.steer(fields);
      case 'LOG_REQUEST_LIST':
        return this.send('LOG_ENTRY', { num_logs: 0 });
      default:
        this.missions.receive(message);
    }
  }

  setMode(customMode: number): void {
    const { modes } = this.autopilot;
    const name = Object.keys(modes).find((key) => modes[key] === customMode);
    if (name === undefined) return;
    this.autopilot.enter(name);
    if (name === 'CIRCLE') this.autopilot.radius = this.circleRadius;
    if (name === 'TAKEOFF') this.autopilot.takeoff(this.parameterOf('TKOFF_ALT') ?? 50);
  }

  /** Sends a message that was requested by its id; returns whether it can. */
  sendRequested(id: number): boolean {
    return this.telemetry.sendById(id);
  }

  private begin(): void {
    const { profile, autopilot } = this;
    if (profile.mission.length > 0) this.loadMission();
    if (profile.activity === 'parked') return;
    autopilot.arm(true);
    autopilot.motion.north += profile.limits.kind === 'hover' ? 0 : 5;
    if (profile.limits.kind === 'wing') {
      autopilot.motion.up = profile.mission[0]?.up ?? 60;
      autopilot.motion.velocityNorth = profile.limits.speed;
    }
    if (profile.activity === 'mission') autopilot.enter('AUTO');
    else if (profile.activity === 'circle') autopilot.enter('LOITER');
    autopilot.remaining = 0.95 - (profile.system % 5) * 0.06;
  }

  private loadMission(): void {
    const { profile, autopilot } = this;
    const item = (seq: number, command: number, params: number[]): void => {
      const name = command === MavCmd.NAV_WAYPOINT ? 'MavCmd.NAV_WAYPOINT' : 'DO_JUMP';
      autopilot.mission.push({
        seq,
        command,
        name,
        frame: seq === 0 ? MavFrame.GLOBAL : MavFrame.GLOBAL_RELATIVE_ALT,
        params,
        autocontinue: true,
      });
    };
    [profile.start, ...profile.mission].forEach((point, seq) => {
      const { latitude, longitude, altitude } = toDegrees(point);
      item(seq, MavCmd.NAV_WAYPOINT, [0, 0, 0, 0, latitude, longitude, seq === 0 ? altitude : point.up]);
    });
    item(profile.mission.length + 1, MavCmd.DO_JUMP, [1, -1, 0, 0, 0, 0, 0]);
    autopilot.start(1);
  }

  private listParameters(): void {
    if (this.listIndex === null) return;
    for (let sent = 0; sent < PARAMETERS_PER_STEP && this.listIndex < this.parameters.length; sent += 1) {
      this.sendParameter(this.listIndex);
      this.listIndex += 1;
    }
    if (this.listIndex >= this.parameters.length) this.listIndex = null;
  }

  private sendParameter(index: number): void {
    const { name, value, type } = this.parameters[index]!;
    const count = this.parameters.length;
    this.send('PARAM_VALUE', {
      param_id: name,
      param_value: value,
      param_type: type,
      param_count: count,
      param_index: index,
    });
  }

  private parameterOf(name: string): number | undefined {
    return this.parameters.find((parameter) => parameter.name === name)?.value;
  }

  /** The radius of the mode CIRCLE in metres. */
  private get circleRadius(): number {
    const centimetres = this.parameterOf('CIRCLE_RADIUS');
    if (centimetres === undefined) return this.profile.limits.radius;
    return (centimetres / 100) * (Math.sign(this.parameterOf('CIRCLE_RATE') ?? 1) || 1);
  }

  private readParameter(name: string, index: number): void {
    const found = index >= 0 ? index : this.parameters.findIndex((parameter) => parameter.name === name);
    if (this.parameters[found] !== undefined) this.sendParameter(found);
  }

  private writeParameter(name: string, value: number): void {
    const index = this.parameters.findIndex((parameter) => parameter.name === name);
    const parameter = this.parameters[index];
    if (parameter === undefined) return;
    parameter.value = Math.fround(value);
    this.sendParameter(index);
  }

  private steer(fields: DecodedMessage['fields']): void {
    const [x, y, z, r] = [fields.x, fields.y, fields.z, fields.r].map((value) => Number(value) / 1000);
    this.autopilot.steer(x ?? 0, y ?? 0, z ?? 0.5, r ?? 0);
  }

  /** Returns the point of a command's place; altitudes are above home unless the frame is global. */
  pointOf(
    frame: number,
    latitude: number,
    longitude: number,
    altitude: number,
  ): { north: number; east: number; up: number } {
    const isSea = frame === MavFrame.GLOBAL || frame === MavFrame.GLOBAL_INT;
    const up = isSea ? altitude - toDegrees({ north: 0, east: 0, up: 0 }).altitude : altitude + this.autopilot.home.up;
    return toMetres(latitude, longitude, up);
  }

  get isArdupilot(): boolean {
    return this.profile.autopilot === ARDUPILOT;
  }

  static readonly interval = POSITION_INTERVAL;
}
