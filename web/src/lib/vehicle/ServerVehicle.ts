/** A vehicle behind the station's server: packets come by the WebSocket, actions go by the HTTP API. */

import { MavSeverity } from '$generated';

import { api as stationApi, type ApiClient } from '$lib/api/client';
import type { ActionFields, ActionName } from '$lib/api/requests';
import type { DecodedMessage } from '$lib/decoder/Decoder';

import { UNKNOWN_CAPABILITIES, capabilitiesFrom, type Capabilities } from './capabilities';
import { sequenceOf } from './missionItem';
import { ObservedVehicle, type Home, type Send } from './ObservedVehicle.svelte';
import type {
  CommandResult,
  Mode,
  OrbitOptions,
  Parameter,
  Plan,
  PlanItem,
  PlanKind,
  ProgressListener,
  StatusText,
  Target,
  Vehicle,
} from './Vehicle';

interface ServerCapabilities {
  readonly [name: string]: boolean | null | readonly string[] | readonly number[];
}

interface ServerPlan {
  readonly home: Plan['home'];
  readonly mission: readonly PlanItem[];
  readonly fence: readonly PlanItem[];
  readonly rally: readonly PlanItem[];
}

interface ServerMode {
  readonly name: string;
  readonly number: number;
  readonly selectable: boolean;
  readonly advanced: boolean;
}

interface ServerText {
  /** In s since 1970, by the clock of the station. */
  readonly time: number;
  readonly severity: string | number;
  readonly text: string;
  readonly component: number;
}

/** The part of the answer of `GET /api/vehicles` that the page follows. */
export interface ServerIdentity {
  readonly system: number;
  readonly conflict?: {
    readonly text: string;
    readonly chosen: string | null;
    readonly senders: readonly {
      readonly channel: string | null;
      readonly type: string;
      readonly unique_id: string | null;
      readonly position: Target | null;
    }[];
  } | null;
}

/** Facts of a vehicle that the page cannot know from the packets of the moment. */
interface ServerFacts extends ServerIdentity {
  readonly capabilities: ServerCapabilities;
  readonly home: Home | null;
  /** The time of the answer, as that of the texts. */
  readonly time?: number;
  readonly status_texts?: readonly ServerText[];
}

/** Capabilities are read again, since the vehicle tells its own by and by. */
const CAPABILITIES_INTERVALS = [2000, 5000, 20_000];

export class ServerVehicle extends ObservedVehicle implements Vehicle {
  private readonly api: ApiClient;
  private timer: ReturnType<typeof setTimeout> | null = null;
  private reads = 0;
  private given: ServerCapabilities | null = null;

  constructor(heartbeat: DecodedMessage, send: Send, api: ApiClient = stationApi) {
    super(heartbeat, send);
    this.api = api;
    this.updateCapabilities();
    void this.readCapabilities();
  }

  override publish(now: number): void {
    const before = this.state.firmware;
    super.publish(now);
    if (this.state.firmware !== before) this.updateCapabilities();
  }

  override dispose(): void {
    super.dispose();
    if (this.timer !== null) clearTimeout(this.timer);
    this.reads = CAPABILITIES_INTERVALS.length;
  }

  getParameter(name: string): Promise<Parameter> {
    return this.api.get(this.path(`parameters/${encodeURIComponent(name)}`));
  }

  async getParameters(onProgress?: ProgressListener): Promise<Parameter[]> {
    const answer = await this.api.longJson<{ parameters: Parameter[] }>('GET', this.path('parameters'), onProgress);
    // Parameters show further equipment, such as a gripper.
    void this.readCapabilities();
    return answer.parameters;
  }

  async setParameter(name: string, value: number): Promise<Parameter> {
    this.refuseInConflict(`setting ${name} of`);
    return this.api.put(this.path(`parameters/${encodeURIComponent(name)}`), { value });
  }

  async sendCommand(command: string | number, params: readonly (number | null)[] = []): Promise<CommandResult> {
    this.refuseInConflict(`command ${command} on`);
    const answer = await this.api.post<{ result: CommandResult }>(this.path('command'), { command, params });
    return answer.result;
  }

  arm(force = false): Promise<void> {
    return this.act('arm', { force });
  }

  disarm(force = false): Promise<void> {
    return this.act('disarm', { force });
  }

  takeoff(altitude: number): Promise<void> {
    return this.act('takeoff', { altitude });
  }

  land(): Promise<void> {
    return this.act('land');
  }

  rtl(): Promise<void> {
    return this.act('rtl');
  }

  hold(): Promise<void> {
    return this.act('hold');
  }

  goto(target: Target, altitude?: number): Promise<void> {
    return this.act('goto', altitude === undefined ? target : { ...target, altitude });
  }

  orbit({ center, ...options }: OrbitOptions): Promise<void> {
    return this.act('orbit', { ...center, ...options });
  }

  lookAt(target: Target | null, altitude = 0): Promise<void> {
    return target === null ? this.act('roi/clear') : this.act('roi', { ...target, altitude });
  }

  setHome(target: Target): Promise<void> {
    return this.act('home', target);
  }

  setSpeed(speed: number): Promise<void> {
    return this.act('speed', { speed });
  }

  setAltitude(altitude: number): Promise<void> {
    return this.act('altitude', { altitude });
  }

  setMode(name: string): Promise<void> {
    return this.act('mode', { mode: name });
  }

  modes(): Promise<Mode[]> {
    return this.api.get<ServerMode[]>(this.path('modes'));
  }

  startMission(arm = false): Promise<void> {
    return this.act('mission/start', { arm });
  }

  pauseMission(): Promise<void> {
    return this.act('mission/pause');
  }

  setMissionItem(number: number): Promise<void> {
    return this.act('mission/current', { seq: sequenceOf(number, this.state.firmware) });
  }

  reboot(): Promise<void> {
    return this.act('reboot');
  }

  perform<Name extends ActionName>(action: Name, fields: ActionFields<Name>): Promise<void> {
    return this.act(action, fields);
  }

  async downloadPlan(kind: PlanKind, onProgress?: ProgressListener): Promise<Plan> {
    const plan = await this.api.longJson<ServerPlan>('GET', this.path(kind), onProgress);
    return { items: plan[kind], home: plan.home };
  }

  async uploadPlan(kind: PlanKind, plan: Plan, onProgress?: ProgressListener): Promise<void> {
    this.refuseInConflict(`uploading the ${kind} to`);
    const file = {
      fileType: 'MavstackPlan',
      version: 1,
      home: plan.home,
      mission: [],
      fence: [],
      rally: [],
      [kind]: plan.items,
    };
    await this.api.longJson('PUT', this.path(kind), onProgress, file);
  }

  async clearPlan(kind: PlanKind): Promise<void> {
    this.refuseInConflict(`clearing the ${kind} of`);
    await this.api.delete(this.path(kind));
  }

  async chooseSender(channel: string | null): Promise<void> {
    this.takeFacts(await this.api.post<ServerIdentity>(this.path('sender'), { channel }));
  }

  async renumber(channel: string | null): Promise<number> {
    const answer = await this.api.longJson<{ id: number }>('POST', this.path('renumber'), undefined, { channel });
    return answer.id;
  }

  /** Takes what the station knows of the vehicle. */
  takeFacts({ conflict = null }: ServerIdentity): void {
    const known = conflict && {
      text: conflict.text,
      chosen: conflict.chosen,
      senders: conflict.senders.map(({ channel, type, unique_id, position }) => ({
        channel,
        type,
        uniqueId: unique_id,
        position,
      })),
    };
    if (JSON.stringify(known) !== JSON.stringify(this.conflict)) this.setConflict(known);
  }

  private path(rest: string): string {
    return `vehicles/${this.system}/${rest}`;
  }

  /** Actions that pilots give are answered once the vehicle has accepted them: flying there may take minutes. */
  private async act<Name extends ActionName>(action: Name, body?: ActionFields<Name>): Promise<void> {
    this.refuseInConflict(`the action ${action} on`);
    await this.api.post(this.path(action), body ?? {}, { accepted: true });
  }

  private updateCapabilities(): void {
    const { firmware, type } = this.state;
    this.currentCapabilities = capabilitiesOf(this.given, capabilitiesFrom(firmware, type, null));
  }

  private async readCapabilities(): Promise<void> {
    try {
      const answer = await this.api.get<ServerFacts>(`vehicles/${this.system}`);
      this.given = answer.capabilities;
      if (answer.home) this.learnHome(answer.home);
      this.takeFacts(answer);
      this.learnTexts(textsOf(answer, this.system));
      this.updateCapabilities();
    } catch {
      // The server may know the vehicle a moment later than the page.
    }
    const interval = CAPABILITIES_INTERVALS[this.reads];
    this.reads += 1;
    if (this.timer !== null) clearTimeout(this.timer);
    if (interval !== undefined) this.timer = setTimeout(() => void this.readCapabilities(), interval);
  }
}

/** Returns the texts that the station keeps, by the clock of the page: that of the station may be another one. */
function textsOf({ time = 0, status_texts: texts = [] }: ServerFacts, system: number): StatusText[] {
  return texts.map(({ component, severity, text, ...each }) => ({
    system,
    component,
    text,
    severity:
      typeof severity === 'number' ? severity : (MavSeverity[severity as keyof typeof MavSeverity] ?? MavSeverity.INFO),
    time: Date.now() - (time - each.time) * 1000,
  }));
}

/** Names of the server's capabilities that differ from the page's. */
const SERVER_NAMES: Readonly<Partial<Record<keyof Capabilities, string>>> = {
  params: 'parameters',
  motorTest: 'motor_test',
  terminate: 'termination',
  ekfSources: 'ekf_sources',
  extendedParameters: 'extended_parameters',
  calibration: 'calibrations',
  manualControl: 'manual_control',
};

/** The server's capabilities, also where it does not know them yet; before its answer those of firmware and type. */
function capabilitiesOf(given: ServerCapabilities | null, expected: Capabilities): Capabilities {
  if (given === null) return expected;
  const names = Object.keys(UNKNOWN_CAPABILITIES) as (keyof Capabilities)[];
  const values = names.map((name) => [name, given[SERVER_NAMES[name] ?? name] ?? UNKNOWN_CAPABILITIES[name]]);
  return Object.fromEntries(values) as Capabilities;
}
