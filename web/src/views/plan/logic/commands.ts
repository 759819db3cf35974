/** The commands of missions: names, params and whether they have a position, from the definitions of MAV_CMD. */

import { MavCmd, MavFrame } from '$generated';

import definitions from '../../../generated/commands.json';

import { item, type Item, type Params, type Place, positionOf } from './model';
import type { Point } from './geo';

export interface ParamInfo {
  /** From 1. */
  readonly index: number;
  readonly label: string;
  readonly units: string;
  /** Name of the enum of its values, such as `MAV_BOOL`; empty without one. */
  readonly enum: string;
  readonly minimum: number | null;
  readonly maximum: number | null;
  readonly increment: number | null;
}

export interface CommandInfo {
  readonly command: number;
  /** Without `MAV_CMD_`. */
  readonly name: string;
  /** As people read it: `Waypoint`. */
  readonly label: string;
  readonly group: CommandGroup;
  /** The params that have a meaning, without position and altitude. */
  readonly params: readonly ParamInfo[];
  readonly hasLocation: boolean;
  /** The vehicle flies to the position. */
  readonly isDestination: boolean;
}

export type CommandGroup = 'navigate' | 'takeoffLand' | 'loiter' | 'condition' | 'action' | 'camera' | 'other';

interface Entry {
  readonly name: string;
  readonly value: number;
  readonly params?: readonly {
    readonly index: number;
    readonly label?: string;
    readonly units?: string;
    readonly enum?: string;
    readonly minimum?: number;
    readonly maximum?: number;
    readonly increment?: number;
    readonly reserved?: boolean;
  }[];
  readonly has_location?: boolean;
  readonly is_destination?: boolean;
}

const PREFIX = 'MAV_CMD_';
const CAMERA = /IMAGE|VIDEO|CAM|GIMBAL|MOUNT|ROI|PHOTO|DIGICAM/;
/** Names that people know from ground stations, where the definition's name would mislead. */
const LABELS: Readonly<Record<number, string>> = {
  [MavCmd.NAV_RETURN_TO_LAUNCH]: 'Return to launch',
  [MavCmd.NAV_LOITER_UNLIM]: 'Loiter (unlimited)',
  [MavCmd.NAV_LOITER_TO_ALT]: 'Loiter to altitude',
  [MavCmd.NAV_VTOL_TAKEOFF]: 'VTOL takeoff',
  [MavCmd.NAV_VTOL_LAND]: 'VTOL land',
  [MavCmd.DO_JUMP]: 'Jump to item',
  [MavCmd.DO_CHANGE_SPEED]: 'Change speed',
  [MavCmd.DO_SET_CAM_TRIGG_DIST]: 'Camera trigger distance',
  [MavCmd.DO_SET_ROI_LOCATION]: 'Region of interest',
};
/** The commands that a picker shows first. */
export const COMMON_COMMANDS: readonly number[] = [
  MavCmd.NAV_WAYPOINT,
  MavCmd.NAV_TAKEOFF,
  MavCmd.NAV_LAND,
  MavCmd.NAV_RETURN_TO_LAUNCH,
  MavCmd.NAV_SPLINE_WAYPOINT,
  MavCmd.NAV_LOITER_TIME,
  MavCmd.NAV_LOITER_TURNS,
  MavCmd.NAV_LOITER_UNLIM,
  MavCmd.NAV_LOITER_TO_ALT,
  MavCmd.NAV_DELAY,
  MavCmd.DO_CHANGE_SPEED,
  MavCmd.DO_JUMP,
  MavCmd.DO_SET_ROI_LOCATION,
  MavCmd.DO_SET_CAM_TRIGG_DIST,
];

/** Returns `Loiter turns` for `NAV_LOITER_TURNS`. */
export function readable(name: string): string {
  const words = name
    .replace(/^(NAV|DO|CONDITION)_/, '')
    .toLowerCase()
    .replaceAll('_', ' ');
  const known = words.replace(/\b(roi|vtol|gps|rtl|ekf|esc|id|usb)\b/g, (word) => word.toUpperCase());
  return known.charAt(0).toUpperCase() + known.slice(1);
}

function groupOf(name: string): CommandGroup {
  if (CAMERA.test(name)) return 'camera';
  if (/TAKEOFF|LAND/.test(name)) return 'takeoffLand';
  if (name.startsWith('NAV_LOITER')) return 'loiter';
  if (name.startsWith('NAV_')) return 'navigate';
  if (name.startsWith('CONDITION_')) return 'condition';
  return name.startsWith('DO_') ? 'action' : 'other';
}

function read(entry: Entry): CommandInfo {
  const name = entry.name.replace(PREFIX, '');
  const hasLocation = entry.has_location ?? false;
  const usable = (entry.params ?? []).filter((each) => !each.reserved && each.label);
  return {
    command: entry.value,
    name,
    label: LABELS[entry.value] ?? readable(name),
    group: groupOf(name),
    params: usable
      .filter((each) => each.index < 5 || !hasLocation)
      .map((each) => ({
        index: each.index,
        label: each.label ?? '',
        units: each.units ?? '',
        enum: each.enum ?? '',
        minimum: each.minimum ?? null,
        maximum: each.maximum ?? null,
        increment: each.increment ?? null,
      })),
    hasLocation,
    isDestination: entry.is_destination ?? false,
  };
}

const ALL: ReadonlyMap<number, CommandInfo> = new Map(
  (definitions as { entries: readonly Entry[] }).entries.map((entry) => [entry.value, read(entry)]),
);

/** Returns what is known of a command; one without a definition has no position and no params. */
export function commandInfo(command: number): CommandInfo {
  const unknown = { label: `Command ${command}`, group: 'other', params: [], hasLocation: false, isDestination: false };
  return ALL.get(command) ?? { command, name: String(command), ...(unknown as Omit<CommandInfo, 'command' | 'name'>) };
}

/** Commands of fences and rally points, and those that only make sense at once, are no items of missions. */
function isMissionCommand(info: CommandInfo): boolean {
  if (info.command >= 5000 && info.command <= 5100) return false;
  return /^(NAV|DO|CONDITION)_|^IMAGE_|^VIDEO_|^SET_CAMERA_|^OBLIQUE_/.test(info.name);
}

/** Returns the commands whose name or number has all words of a text, the common ones first. */
export function findCommands(text: string): CommandInfo[] {
  const words = text
    .toLowerCase()
    .split(/[\s_]+/)
    .filter(Boolean);
  const rank = (info: CommandInfo): number => {
    const at = COMMON_COMMANDS.indexOf(info.command);
    return at < 0 ? COMMON_COMMANDS.length : at;
  };
  return [...ALL.values()]
    .filter(isMissionCommand)
    .filter((info) => {
      const searched = `${info.label} ${info.name} ${info.command}`.toLowerCase();
      return words.every((word) => searched.includes(word));
    })
    .sort((a, b) => rank(a) - rank(b) || a.label.localeCompare(b.label));
}

/** Returns the position of an item; null if it has none. */
export function itemPosition(each: Item): Point | null {
  return positionOf(each, commandInfo(each.command).hasLocation);
}

/** Returns whether the vehicle flies to the position of an item. */
export function isOnPath(each: Item): boolean {
  const info = commandInfo(each.command);
  return info.isDestination && itemPosition(each) !== null;
}

const DEFAULT_PARAMS: Readonly<Record<number, Params>> = {
  [MavCmd.NAV_LOITER_TIME]: [30, 0, 0, 1],
  [MavCmd.NAV_LOITER_TURNS]: [2, 0, 20, 1],
  [MavCmd.NAV_LOITER_UNLIM]: [0, 0, 20, null],
  [MavCmd.NAV_LOITER_TO_ALT]: [0, 20, 0, 1],
  [MavCmd.NAV_DELAY]: [10, -1, -1, -1],
  [MavCmd.DO_CHANGE_SPEED]: [1, 5, -1],
  [MavCmd.DO_JUMP]: [0, 1],
  [MavCmd.DO_SET_CAM_TRIGG_DIST]: [25, 0, 1],
  [MavCmd.NAV_TAKEOFF]: [0, 0, 0, null],
  [MavCmd.NAV_LAND]: [0, 0, 0, null],
  [MavCmd.NAV_WAYPOINT]: [0, 0, 0, null],
};

/** Returns a new item of a command at a place, whose altitude is in metres in the frame. */
export function newItem(command: number, at: Place, frame: number = MavFrame.GLOBAL_RELATIVE_ALT): Item {
  const first = DEFAULT_PARAMS[command] ?? [];
  if (!commandInfo(command).hasLocation) return item(command, first, MavFrame.MISSION);
  const four = Array.from({ length: 4 }, (_, index) => (index < first.length ? first[index]! : 0));
  const altitude = command === MavCmd.NAV_LAND ? 0 : at.altitude;
  return item(command, [...four, at.latitude, at.longitude, altitude], frame);
}

/** Returns an item with another command, which keeps its position, altitude and frame where both have them. */
export function withCommand(each: Item, command: number, at: Place): Item {
  const place = itemPosition(each) ?? at;
  const altitude = commandInfo(each.command).hasLocation ? (each.params[6] ?? at.altitude) : at.altitude;
  const frame = each.frame === MavFrame.MISSION ? MavFrame.GLOBAL_RELATIVE_ALT : each.frame;
  return newItem(command, { ...place, altitude: altitude || at.altitude }, frame);
}

export function itemLabel(each: Item): string {
  return each.kept ? each.kept.kind : commandInfo(each.command).label;
}
