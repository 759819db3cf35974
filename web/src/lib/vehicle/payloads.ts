/** Cameras and gimbals of a vehicle, as the station's API shows them. */

import { CameraCapFlags, GimbalManagerCapFlags } from '$generated';
import { api as stationApi, type ApiClient } from '$lib/api/client';

export interface GimbalView {
  readonly id: string;
  readonly information: {
    readonly capabilities: number;
    readonly pitch_range: readonly [number, number];
    readonly yaw_range: readonly [number, number];
    readonly vendor: string;
    readonly model: string;
  } | null;
  /** Addresses such as `255/190`. */
  readonly controlled_by: readonly string[];
  readonly in_control: boolean;
  readonly attitude: {
    readonly roll: number;
    readonly pitch: number;
    readonly yaw: number | null;
    readonly heading: number | null;
    readonly flags: number;
  } | null;
}

export interface CameraView {
  readonly id: number;
  readonly information: {
    readonly vendor: string;
    readonly model: string;
    readonly capabilities: number;
    readonly definition_uri: string;
  } | null;
  readonly status: { readonly mode: number; readonly zoom: number | null; readonly focus: number | null } | null;
  readonly capture: {
    /** Seconds between the photos of a series; null: no series runs. */
    readonly interval: number | null;
    readonly recording: boolean;
    readonly recording_time: number;
    readonly image_count: number;
    /** In MiB. */
    readonly available: number;
  } | null;
  readonly storages: readonly {
    readonly id: number;
    readonly name: string;
    readonly total: number;
    readonly used: number;
  }[];
}

export interface CameraSetting {
  readonly name: string;
  readonly description: string;
  readonly value: number | string | null;
  readonly options: Readonly<Record<string, number | string>>;
  readonly minimum: number | null;
  readonly maximum: number | null;
  readonly step: number | null;
  readonly unit: string;
  readonly readonly: boolean;
  readonly is_bool: boolean;
  readonly available: boolean;
}

/** The part of a camera that a flag stands for. */
export type CameraFeature =
  | 'photos'
  | 'video'
  | 'modes'
  | 'zoom'
  | 'focus'
  | 'trackPoint'
  | 'trackRectangle'
  | 'settings';

const FEATURES: Readonly<Record<Exclude<CameraFeature, 'settings'>, number>> = {
  photos: CameraCapFlags.CAPTURE_IMAGE,
  video: CameraCapFlags.CAPTURE_VIDEO,
  modes: CameraCapFlags.HAS_MODES,
  zoom: CameraCapFlags.HAS_BASIC_ZOOM,
  focus: CameraCapFlags.HAS_BASIC_FOCUS,
  trackPoint: CameraCapFlags.HAS_TRACKING_POINT,
  trackRectangle: CameraCapFlags.HAS_TRACKING_RECTANGLE,
};

/** Whether a camera has a feature; one that has not told its flags may have it, but for its settings. */
export function hasFeature({ information }: Pick<CameraView, 'information'>, feature: CameraFeature): boolean {
  if (information === null) return feature !== 'settings';
  if (feature === 'settings') return information.definition_uri !== '';
  return (information.capabilities & FEATURES[feature]) !== 0;
}

export interface Ranges {
  readonly pitch: readonly [number, number];
  readonly yaw: readonly [number, number];
}

const ALL_PITCHES: readonly [number, number] = [-90, 90];
const ALL_YAWS: readonly [number, number] = [-180, 180];

/** Returns the angles that a gimbal reaches, in whole degrees; an axis that it lacks has the range 0 … 0. */
export function rangesOf({ information }: Pick<GimbalView, 'information'>): Ranges {
  if (information === null) return { pitch: ALL_PITCHES, yaw: ALL_YAWS };
  const has = (flag: number): boolean => (information.capabilities & flag) !== 0;
  const whole = (range: readonly [number, number], full: readonly [number, number]): readonly [number, number] => {
    const [low, high] = [Math.max(Math.round(range[0]), full[0]), Math.min(Math.round(range[1]), full[1])];
    return low < high ? [low, high] : full;
  };
  return {
    pitch: has(GimbalManagerCapFlags.HAS_PITCH_AXIS) ? whole(information.pitch_range, ALL_PITCHES) : [0, 0],
    yaw: has(GimbalManagerCapFlags.HAS_YAW_AXIS) ? whole(information.yaw_range, ALL_YAWS) : [0, 0],
  };
}

/** The payloads of one vehicle behind the station. */
export class Payloads {
  private readonly system: number;
  private readonly api: ApiClient;

  constructor(system: number, api: ApiClient = stationApi) {
    this.system = system;
    this.api = api;
  }

  gimbals(): Promise<GimbalView[]> {
    return this.api.get(this.path('gimbals'));
  }

  /** Returns the last report of a gimbal, without a question to the vehicle. */
  gimbal(id: string): Promise<GimbalView> {
    return this.api.get(this.path(`gimbals/${id}`));
  }

  moveGimbal(id: string, action: string, fields: object = {}): Promise<GimbalView> {
    return this.api.post(this.path(`gimbals/${id}/${action}`), fields, { accepted: true });
  }

  cameras(cached = false): Promise<CameraView[]> {
    return this.api.get(this.path('cameras'), { cached });
  }

  useCamera(id: number, action: string, fields: object = {}): Promise<unknown> {
    return this.api.post(this.path(`cameras/${id}/${action}`), fields);
  }

  async settings(id: number): Promise<CameraSetting[]> {
    return (await this.api.get<{ settings: CameraSetting[] }>(this.path(`cameras/${id}/settings`))).settings;
  }

  async setSetting(id: number, name: string, value: number | string): Promise<CameraSetting[]> {
    const path = this.path(`cameras/${id}/settings/${encodeURIComponent(name)}`);
    return (await this.api.put<{ settings: CameraSetting[] }>(path, { value })).settings;
  }

  private path(rest: string): string {
    return `vehicles/${this.system}/${rest}`;
  }
}
