/** Problems of all vehicles that a pilot must not miss, the gravest first. */
import { GpsFixType, MavBatteryChargeState, MavSeverity, MavState } from '$generated';
import { t, type TextKey, type TextValues } from '$lib/i18n';
import { batteryLevel, estimatorLevel, type Level, vibrationLevel } from '$lib/instruments/status';
import { distance } from '$lib/map/geometry';
import type { Aircraft } from '$lib/map/traffic';
import { allowsArming, startsByItself, waitingMode } from '$lib/vehicle/link/modes';
import type { Stream } from '$lib/vehicle/streams';
import type { StatusText, VehicleState } from '$lib/vehicle/Vehicle';

import { usesAirSpeed } from './reading';

export interface Alert {
  readonly system: number;
  readonly isCritical: boolean;
  readonly text: TextKey;
  readonly values: TextValues;
  /** Metres that the text shows, by name. */
  readonly lengths?: Readonly<Record<string, number>>;
}

interface Surroundings {
  /** In ms since 1970. */
  readonly now: number;
  readonly aircraft: readonly Aircraft[];
}

type Finder = (state: VehicleState, surroundings: Surroundings) => Alert | null;

/** Critical status texts and graver ones are shown for a while. */
const TEXT_TIME = 15_000;
/** Aircraft within these distances in m, both horizontally and vertically. */
const NEAR = { horizontal: 2000, vertical: 300 };
const VERY_NEAR = { horizontal: 600, vertical: 120 };
/** Reports of aircraft that are older are no news. */
const TRAFFIC_TIME = 15_000;
const CHECKS = ['PreArm: ', 'Arm: ', 'Preflight Fail: ', 'Arming denied: '];
/** Failed checks of one run arrive within this time, and are told again at least this often. */
const CHECKS_RUN = 3000;
const CHECKS_LIFETIME = 40_000;

const STREAM_NAMES: Readonly<Record<Stream, TextKey>> = {
  attitude: 'fly.streamAttitude',
  position: 'fly.streamPosition',
  speed: 'fly.streamSpeed',
  airspeed: 'fly.streamAirspeed',
  gps: 'fly.streamGps',
  battery: 'fly.streamBattery',
};

const isGraver = (one: Alert, other: Alert): number => Number(other.isCritical) - Number(one.isCritical);

/** Returns the alerts of vehicles; of equal ones those of the selected vehicle come first. */
export function alertsOf(
  states: readonly VehicleState[],
  surroundings: Surroundings,
  selected: number | null,
): Alert[] {
  const found = states.flatMap((state) =>
    FINDERS.map((find) => find(state, surroundings)).filter((alert): alert is Alert => alert !== null),
  );
  const isOther = ({ system }: Alert): number => Number(system !== selected);
  return found.sort((one, other) => isGraver(one, other) || isOther(one) - isOther(other) || one.system - other.system);
}

/** Returns the reasons why a vehicle does not arm, as it told them last. */
export function armingProblems(texts: readonly StatusText[], now: number): string[] {
  const checks = texts.filter(({ text }) => CHECKS.some((prefix) => text.startsWith(prefix)));
  const last = checks.at(-1)?.time ?? 0;
  if (now - last > CHECKS_LIFETIME) return [];
  const run = checks.filter(({ time }) => time >= last - CHECKS_RUN);
  return [...new Set(run.map(({ text }) => text.slice(text.indexOf(': ') + 2)))];
}

/** Returns in words what the mode of a disarmed vehicle means for arming; null: it arms there, and stays. */
export function modeObstacle(state: Pick<VehicleState, 'firmware' | 'type' | 'mode'>): string | null {
  const [mode, next] = [state.mode ?? '', waitingMode(state)];
  if (!allowsArming(state))
    return next === null ? t('fly.notArmable', { mode }) : t('fly.readyElsewhere', { mode, next });
  return startsByItself(state) ? t('fly.startsAlone', { mode }) : null;
}

function alert({ system }: VehicleState, level: Level | boolean, text: TextKey, values: TextValues = {}): Alert {
  return { system, isCritical: level === true || level === 'critical', text, values };
}

const isFlying = (state: VehicleState): boolean => state.armed === true && state.inAir !== false;

const FINDERS: readonly Finder[] = [
  function conflict(state) {
    if (state.conflict === null) return null;
    const { chosen } = state.conflict;
    if (chosen === null) return alert(state, true, 'fly.alertConflict', { system: state.system });
    return alert(state, false, 'fly.alertConflictChosen', { system: state.system, channel: chosen });
  },
  function lost(state) {
    return state.alive ? null : alert(state, state.armed === true, 'fly.alertLost');
  },
  function silent(state) {
    const names = state.overdue
      .filter((stream) => stream !== 'airspeed' || usesAirSpeed(state))
      .map((stream) => t(STREAM_NAMES[stream]));
    if (names.length === 0) return null;
    const isBlind = isFlying(state) && state.overdue.some((stream) => stream === 'attitude' || stream === 'position');
    return alert(state, isBlind, 'fly.alertSilent', { streams: names.join(', ') });
  },
  function terminated(state) {
    return state.systemStatus === MavState.FLIGHT_TERMINATION ? alert(state, true, 'fly.alertTermination') : null;
  },
  function failsafe(state) {
    const isOn = state.systemStatus === MavState.CRITICAL || state.systemStatus === MavState.EMERGENCY;
    return isOn && state.armed ? alert(state, true, 'fly.alertFailsafe', { mode: state.mode ?? '–' }) : null;
  },
  function battery(state) {
    const { remaining = null, voltage = null, cells = [], chargeState = null } = state.battery ?? {};
    const charge = chargeState ?? 0;
    const byVolts = cells.length > 0 ? Math.min(...cells) : null;
    const isCritical = charge >= MavBatteryChargeState.CRITICAL && charge <= MavBatteryChargeState.UNHEALTHY;
    const level = isCritical ? 'critical' : batteryLevel(remaining, byVolts);
    const isLow =
      charge === MavBatteryChargeState.LOW || level === 'critical' || (level === 'warning' && isFlying(state));
    if (!isLow) return null;
    const left = remaining === null ? '' : `${Math.round(remaining * 100)}%`;
    const volts = voltage === null ? '' : `${voltage.toFixed(1)} V`;
    const values = { value: [left, volts].filter((part) => part !== '').join(' · ') };
    return alert(state, level, level === 'critical' ? 'fly.alertBatteryCritical' : 'fly.alertBatteryLow', values);
  },
  function fence(state) {
    return state.fenceBreached ? alert(state, true, 'fly.alertFence') : null;
  },
  function gps(state) {
    if (!isFlying(state) || state.gps === null || state.gps.fix >= GpsFixType._3D_FIX) return null;
    return alert(state, true, 'fly.alertGps');
  },
  function estimator(state) {
    const { estimator: estimate } = state;
    if (estimate === null || !state.armed) return null;
    const level = estimatorLevel(estimate.ratio, estimate.isInitialized);
    if (level !== 'critical') return null;
    return alert(state, level, 'fly.alertEstimator', { ratio: estimate.ratio.toFixed(1) });
  },
  function vibration(state) {
    const level = vibrationLevel(state.vibration?.level ?? null);
    if (!isFlying(state) || (level !== 'warning' && level !== 'critical')) return null;
    return alert(state, level, 'fly.alertVibration', { level: Math.round(state.vibration!.level) });
  },
  traffic,
  function message(state, { now }) {
    const text = state.statusTexts.filter(({ severity }) => severity <= MavSeverity.CRITICAL).at(-1);
    if (text === undefined || now - text.time > TEXT_TIME) return null;
    if (CHECKS.some((prefix) => text.text.startsWith(prefix))) return null;
    return alert(state, true, 'fly.alertText', { text: text.text });
  },
];

function traffic(state: VehicleState, { aircraft, now }: Surroundings): Alert | null {
  const { position } = state;
  if (position === null || !isFlying(state)) return null;
  const near = aircraft
    .filter(({ time }) => now - time < TRAFFIC_TIME)
    .map((each) => ({
      callsign: each.callsign,
      horizontal: distance(position, each),
      // Without an altitude it may be at that of the vehicle.
      vertical: each.altitude === null || position.altitude === null ? 0 : each.altitude - position.altitude,
    }))
    .filter(({ horizontal, vertical }) => horizontal < NEAR.horizontal && Math.abs(vertical) < NEAR.vertical)
    .sort((one, other) => one.horizontal - other.horizontal)[0];
  if (near === undefined) return null;
  const isVeryNear = near.horizontal < VERY_NEAR.horizontal && Math.abs(near.vertical) < VERY_NEAR.vertical;
  const key = near.vertical >= 0 ? 'fly.alertTrafficAbove' : 'fly.alertTrafficBelow';
  const lengths = { horizontal: near.horizontal, vertical: Math.abs(near.vertical) };
  return { ...alert(state, isVeryNear, key, { callsign: near.callsign }), lengths };
}
