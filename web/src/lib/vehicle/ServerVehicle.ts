/** A vehicle behind the station's server: packets come by the WebSocket, actions go by the HTTP API. */

import { api as stationApi, type ApiClient } from '$lib/api/client';
import type { DecodedMessage } from '$lib/decoder/Decoder';

import { UNKNOWN_CAPABILITIES, capabilitiesFrom, type Capabilities } from './capabilities';
import { sequenceOf } from './missionItem';
import { ObservedVehicle, type Home, type Send } from './ObservedVehicle.svelte';
import type {
  CommandResult, Mode, OrbitOptions, Parameter, Plan, PlanItem, PlanKind, ProgressListener, Target, Vehicle,
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
    return answer.parameters;
  }

  setParameter(name: string, value: number): Promise<Parameter> {
    return this.api.put(this.path(`parameters/${encodeURIComponent(name)}`), { value });
  }

  async sendCommand(command: string | number, params: readonly (number | null)[] = []): Promise<CommandResult> {
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

  startMission(): Promise<void> {
    return this.act('mission/start');
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

  async downloadPlan(kind: PlanKind, onProgress?: ProgressListener): Promise<Plan> {
    const plan = await this.api.longJson<ServerPlan>('GET', this.path(kind), onProgress);
    return { items: plan[kind], home: plan.home };
  }

  async uploadPlan(kind: PlanKind, plan: Plan, onProgress?: ProgressListener): Promise<void> {
    const file = { fileType: 'MavstackPlan', version: 1, home: plan.home, mission: [], fence: [], rally: [], [kind]: plan.items };
    await this.api.longJson('PUT', this.path(kind), onProgress, file);
  }

  async clearPlan(kind: PlanKind): Promise<void> {
    await this.api.delete(this.path(kind));
  }

  private path(rest: string): string {
    return `vehicles/${this.system}/${rest}`;
  }

  /** Actions that pilots give are answered once the vehicle has accepted them: flying there may take minutes. */
  private async act(action: string, body: object = {}): Promise<void> {
    await this.api.post(this.path(action), body, { accepted: true });
  }

  private updateCapabilities(): void {
    const { firmware, type } = this.state;
    this.currentCapabilities = capabilitiesOf(this.given, capabilitiesFrom(firmware, type, null));
  }

  private async readCapabilities(): Promise<void> {
    try {
      const answer = await this.api.get<{ capabilities: ServerCapabilities; home: Home | null }>(`vehicles/${this.system}`);
      this.given = answer.capabilities;
      if (answer.home) this.learnHome(answer.home);
      this.updateCapabilities();
    } catch {
      // The server may know the vehicle a moment later than the page.
    }
    const interval = CAPABILITIES_INTERVALS[this.reads];
    this.reads += 1;
    if (interval !== undefined) this.timer = setTimeout(() => void this.readCapabilities(), interval);
  }
}

/** Names of the server's capabilities that differ from the page's. */
const SERVER_NAMES: Readonly<Partial<Record<keyof Capabilities, string>>> = {
  params: 'parameters',
  motorTest: 'motor_test',
  terminate: 'termination',
  ekfSources: 'ekf_sources',
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
