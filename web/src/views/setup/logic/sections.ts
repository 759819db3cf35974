/** The parameters of flight modes, failsafes, outputs and the estimator, by firmware. */

import type { ParameterTable } from './parameters';

export interface Group {
  /** Key of the title in the catalogue, below `setup.`. */
  readonly title: GroupTitle;
  readonly names: readonly RegExp[];
}

export type GroupTitle =
  | 'groupModes'
  | 'groupModeSwitch'
  | 'groupBattery'
  | 'groupLink'
  | 'groupRadio'
  | 'groupGeofence'
  | 'groupEstimator'
  | 'groupReturn'
  | 'groupArming'
  | 'groupMotors'
  | 'groupSource'
  | 'groupVtx'
  | 'groupOsd'
  | 'groupMonitor'
  | 'groupReceiver'
  | 'groupSticks'
  | 'groupRateLoop'
  | 'groupAngleLoop'
  | 'groupPilotRates'
  | 'groupFilters';

const group = (title: GroupTitle, ...names: RegExp[]): Group => ({ title, names });

export const FLIGHT_MODES: readonly Group[] = [
  group('groupModes', /^FLTMODE[1-6]$/, /^MODE[1-6]$/, /^COM_FLTMODE[1-6]$/),
  group(
    'groupModeSwitch',
    /^(FLT)?MODE_CH$/,
    /^FLTMODE_CH$/,
    /^RC_MAP_(FLTMODE|RETURN_SW|KILL_SW|ARM_SW|OFFB_SW|LOITER_SW)$/,
    /^(SUPER_)?SIMPLE$/,
  ),
];

export const FAILSAFES: readonly Group[] = [
  group('groupBattery', /^BATT_(FS_|LOW_|CRT_|CAPACITY)/, /^BAT_(LOW|CRIT|EMERGEN)_THR$/, /^COM_LOW_BAT_ACT$/),
  group('groupLink', /^FS_GCS_/, /^FS_LONG_|^FS_SHORT_/, /^NAV_DLL_ACT$/, /^COM_DL_LOSS_T$/),
  group(
    'groupRadio',
    /^FS_THR_/,
    /^THR_FAILSAFE$/,
    /^THR_FS_VALUE$/,
    /^RC_FS_TIMEOUT$/,
    /^NAV_RCL_ACT$/,
    /^COM_RC_LOSS_T$/,
    /^COM_RC_IN_MODE$/,
  ),
  group('groupGeofence', /^FENCE_(ENABLE|ACTION|TYPE|ALT_MAX|ALT_MIN|RADIUS|MARGIN|AUTOENABLE)$/, /^GF_/),
  group(
    'groupEstimator',
    /^FS_EKF_/,
    /^FS_VIBE_ENABLE$/,
    /^FS_DR_/,
    /^FS_CRASH_CHECK$/,
    /^FS_OPTIONS$/,
    /^COM_POSCTL_NAVL$/,
    /^COM_VEL_FS_EVH$/,
  ),
  group('groupReturn', /^RTL_/),
  group('groupArming', /^ARMING_/, /^COM_ARM_/, /^COM_PREARM_MODE$/, /^DISARM_DELAY$/, /^COM_DISARM_/),
];

export const OUTPUTS: readonly Group[] = [
  group(
    'groupMotors',
    /^FRAME_(CLASS|TYPE)$/,
    /^MOT_(PWM_|SPIN_|SPOOL|THST)/,
    /^CA_(AIRFRAME|ROTOR_COUNT)$/,
    /^PWM_(MAIN|AUX)_(TIM|RATE)/,
    /^BF_MOTOR_/,
  ),
];

export const ESTIMATOR: readonly Group[] = [
  group(
    'groupEstimator',
    /^AHRS_EKF_TYPE$/,
    /^EK[23]_ENABLE$/,
    /^EKF2_(EN|GPS_CTRL|EV_CTRL|OF_CTRL|RNG_CTRL|BARO_CTRL|HGT_REF|MAG_TYPE|GPS_MODE)$/,
  ),
  group('groupSource', /^EK3_SRC\d_/, /^EK3_SRC_OPTIONS$/),
];

export const BATTERY: readonly Group[] = [
  group('groupMonitor', /^BATT\d?_(?!FS_|LOW_|CRT_|ARM_)/, /^BAT\d?_(?!LOW_|CRIT_|EMERGEN_)/),
  FAILSAFES[0]!,
];

export const RECEIVER: readonly Group[] = [
  group(
    'groupReceiver',
    /^RC_(PROTOCOLS|OPTIONS|SPEED|CHAN_CNT|FAILS_THR|INPUT_PROTO|PORT_CONFIG)$/,
    /^COM_RC_IN_MODE$/,
    /^RC_MAP_FAILSAFE$/,
    /^RSSI_/,
    /^RC_RSSI_/,
  ),
  group('groupSticks', /^RCMAP_/, /^RC_MAP_(ROLL|PITCH|YAW|THROTTLE)$/, /^RC\d+_(REVERSED|REV)$/),
];

export const TUNED_AXES = ['roll', 'pitch', 'yaw'] as const;
export type TunedAxis = (typeof TUNED_AXES)[number];

/** The abbreviations of an axis in the parameters of ArduPilot, and of PX4 and MSP. */
const AXIS_NAMES: Readonly<Record<TunedAxis, { ardupilot: string; servo: string; plane: string; whole: string }>> = {
  roll: { ardupilot: 'RLL', servo: 'RLL2SRV', plane: 'R', whole: 'ROLL' },
  pitch: { ardupilot: 'PIT', servo: 'PTCH2SRV', plane: 'P', whole: 'PITCH' },
  yaw: { ardupilot: 'YAW', servo: 'YAW2SRV', plane: 'Y', whole: 'YAW' },
};

/** Rates of Betaflight and iNav whose names have no axis, or another order. */
const MSP_RATES: Readonly<Record<TunedAxis, readonly RegExp[]>> = {
  roll: [/^BF_RC_(RATE|EXPO)$/, /^BF_RATE_RC_(RATE|EXPO)$/, /^INAV_MAN_EXPO$/],
  pitch: [/^BF_RC_EXPO$/, /^BF_RATE_RC_EXPO$/, /^INAV_MAN_EXPO$/],
  yaw: [/^BF_RC_YAW_EXPO$/],
};

/** Returns the parameters that decide how a vehicle follows its set-points about an axis. */
export function tuningGroups(axis: TunedAxis): readonly Group[] {
  const { ardupilot, servo, plane, whole } = AXIS_NAMES[axis];
  const acro = axis === 'yaw' ? 'Y' : 'RP';
  return [
    group(
      'groupRateLoop',
      new RegExp(`^(Q_A|ATC)_RAT_${ardupilot}_(P|I|D|FF|D_FF|IMAX|SMAX|PDMX)$`),
      new RegExp(`^(${servo}|${ardupilot === 'PIT' ? 'PTCH' : ardupilot}_RATE)_`),
      new RegExp(`^MC_${whole}RATE_[PIDK]$|^MC_${whole}RATE_FF$|^FW_${plane}R_(P|I|D|FF|IMAX)$`),
      new RegExp(`^BF_PID_${whole}_[PIDF]$|^BF_D_MIN_${whole}$`),
      ...(axis === 'yaw' ? [/^ATC_STR_RAT_/] : []),
    ),
    group(
      'groupAngleLoop',
      new RegExp(`^(Q_A|ATC)_ANG_${ardupilot}_P$|^MC_${whole}_P$|^FW_${plane}_(TC|RMAX)$`),
      ...(axis === 'yaw' ? [] : [/^BF_PID_LEVEL_[PIDF]$/]),
    ),
    group(
      'groupPilotRates',
      new RegExp(`^ACRO_${acro}_|^MC_ACRO_${plane}_MAX$|^MC_${whole}RATE_MAX$`),
      new RegExp(`^(Q_A|ATC)_(ACCEL|RATE)_${plane}_MAX$`),
      new RegExp(`^BF_${whole}_(RC_RATE|RATE|EXPO|RATE?_LIM)$|^BF_RATE_${whole}$|^INAV_MAN_${whole}(_EXP)?$`),
      ...MSP_RATES[axis],
    ),
    group(
      'groupFilters',
      new RegExp(`^(Q_A|ATC)_RAT_${ardupilot}_FLT[TED]$`),
      /^INS_GYRO_FILTER$/,
      /^BF_(GYRO|DTERM)_LPF[12]_HZ$/,
    ),
  ];
}

export const VTX: readonly Group[] = [group('groupVtx', /^BF_VTX_/, /^VTX_/)];
export const OSD: readonly Group[] = [group('groupOsd', /^BF_OSD_(?!\d)/, /^OSD_(?!\d)/)];

/** Returns the groups that the vehicle has parameters of, with their names in order. */
export function namesOf(
  groups: readonly Group[],
  parameters: ParameterTable,
): { title: GroupTitle; names: string[] }[] {
  const all = Object.keys(parameters);
  const collator = new Intl.Collator('en', { numeric: true });
  return groups
    .map(({ title, names }) => ({
      title,
      names: all.filter((name) => names.some((pattern) => pattern.test(name))).sort(collator.compare),
    }))
    .filter(({ names }) => names.length > 0);
}
