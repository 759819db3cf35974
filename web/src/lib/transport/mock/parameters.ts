/** Parameters of the vehicles of the demo: names and values as those of ArduPilot and Betaflight. */

import { MavParamType } from '$generated';
import type { VehicleType } from '$lib/vehicle/Vehicle';

import { ARDUPILOT, type MockProfile } from './profiles';

export interface MockParameter {
  readonly name: string;
  value: number;
  /** MAV_PARAM_TYPE. */
  readonly type: number;
}

const { INT8, INT16, INT32, REAL32 } = MavParamType;

type Table = Readonly<Record<string, readonly [value: number, type: number]>>;

const COMMON: Table = {
  ARMING_CHECK: [1, INT32],
  ARMING_REQUIRE: [1, INT8],
  AHRS_EKF_TYPE: [3, INT8],
  AHRS_ORIENTATION: [0, INT8],
  AHRS_TRIM_X: [0.0012, REAL32],
  AHRS_TRIM_Y: [-0.0043, REAL32],
  BATT_MONITOR: [4, INT8],
  BATT_CAPACITY: [5200, INT32],
  BATT_LOW_VOLT: [14.4, REAL32],
  BATT_CRT_VOLT: [13.8, REAL32],
  BATT_FS_LOW_ACT: [2, INT8],
  BATT_FS_CRT_ACT: [1, INT8],
  BATT_LOW_MAH: [0, REAL32],
  BRD_SAFETY_DEFLT: [0, INT8],
  COMPASS_AUTODEC: [1, INT8],
  COMPASS_DEC: [0.048, REAL32],
  COMPASS_OFS_X: [12.4, REAL32],
  COMPASS_OFS_Y: [-31.7, REAL32],
  COMPASS_OFS_Z: [4.2, REAL32],
  COMPASS_USE: [1, INT8],
  EK3_ENABLE: [1, INT8],
  EK3_SRC1_POSXY: [3, INT8],
  EK3_SRC1_POSZ: [1, INT8],
  EK3_SRC1_VELXY: [3, INT8],
  EK3_SRC1_YAW: [1, INT8],
  FENCE_ACTION: [1, INT8],
  FENCE_ALT_MAX: [100, REAL32],
  FENCE_ENABLE: [0, INT8],
  FENCE_RADIUS: [300, REAL32],
  FENCE_TYPE: [7, INT8],
  FS_GCS_ENABLE: [0, INT8],
  FS_OPTIONS: [16, INT32],
  GPS1_TYPE: [1, INT8],
  INS_ACCOFFS_X: [0.031, REAL32],
  INS_ACCOFFS_Y: [0.008, REAL32],
  INS_ACCOFFS_Z: [-0.11, REAL32],
  INS_GYRO_FILTER: [20, INT16],
  LOG_BACKEND_TYPE: [1, INT8],
  LOG_BITMASK: [176126, INT32],
  LOG_DISARMED: [0, INT8],
  MIS_RESTART: [0, INT8],
  OSD_TYPE: [0, INT8],
  RALLY_LIMIT_KM: [0.3, REAL32],
  RC1_MAX: [1900, INT16],
  RC1_MIN: [1100, INT16],
  RC1_TRIM: [1500, INT16],
  RC2_MAX: [1900, INT16],
  RC2_MIN: [1100, INT16],
  RC3_MAX: [1900, INT16],
  RC3_MIN: [1100, INT16],
  RC4_MAX: [1900, INT16],
  RC4_MIN: [1100, INT16],
  RCMAP_ROLL: [1, INT8],
  RCMAP_PITCH: [2, INT8],
  RCMAP_THROTTLE: [3, INT8],
  RCMAP_YAW: [4, INT8],
  RSSI_TYPE: [0, INT8],
  SCHED_LOOP_RATE: [400, INT16],
  SERIAL0_BAUD: [115, INT32],
  SERIAL1_BAUD: [57, INT32],
  SERIAL1_PROTOCOL: [2, INT8],
  SERVO1_FUNCTION: [33, INT16],
  SERVO1_MAX: [1900, INT16],
  SERVO1_MIN: [1100, INT16],
  SERVO1_TRIM: [1500, INT16],
  SERVO2_FUNCTION: [34, INT16],
  SERVO3_FUNCTION: [35, INT16],
  SERVO4_FUNCTION: [36, INT16],
  STAT_BOOTCNT: [42, INT16],
  STAT_FLTTIME: [73120, INT32],
};

const COPTER: Table = {
  CIRCLE_OPTIONS: [1, INT16],
  CIRCLE_RADIUS: [1000, REAL32],
  CIRCLE_RATE: [20, REAL32],
  ANGLE_MAX: [3000, INT16],
  ATC_ANG_PIT_P: [4.5, REAL32],
  ATC_ANG_RLL_P: [4.5, REAL32],
  ATC_RAT_PIT_P: [0.135, REAL32],
  ATC_RAT_RLL_P: [0.135, REAL32],
  FLTMODE1: [0, INT8],
  FLTMODE2: [2, INT8],
  FLTMODE3: [5, INT8],
  FLTMODE4: [4, INT8],
  FLTMODE5: [6, INT8],
  FLTMODE6: [9, INT8],
  FLTMODE_CH: [5, INT8],
  FRAME_CLASS: [1, INT8],
  FRAME_TYPE: [1, INT8],
  FS_THR_ENABLE: [1, INT8],
  FS_THR_VALUE: [975, INT16],
  LAND_SPEED: [50, INT16],
  MOT_SPIN_ARM: [0.1, REAL32],
  MOT_SPIN_MIN: [0.15, REAL32],
  PILOT_SPEED_UP: [250, INT16],
  RTL_ALT: [1500, INT32],
  RTL_LOIT_TIME: [5000, INT32],
  WPNAV_ACCEL: [250, REAL32],
  WPNAV_RADIUS: [200, REAL32],
  WPNAV_SPEED: [800, REAL32],
};

const PLANE: Table = {
  AIRSPEED_CRUISE: [17, REAL32],
  AIRSPEED_MAX: [22, INT16],
  AIRSPEED_MIN: [11, INT16],
  ARSPD_TYPE: [1, INT8],
  FLTMODE1: [11, INT8],
  FLTMODE2: [5, INT8],
  FLTMODE3: [12, INT8],
  FLTMODE4: [10, INT8],
  FLTMODE5: [2, INT8],
  FLTMODE6: [0, INT8],
  FLTMODE_CH: [8, INT8],
  NAVL1_PERIOD: [17, REAL32],
  ROLL_LIMIT_DEG: [45, REAL32],
  RTL_ALTITUDE: [60, REAL32],
  TECS_CLMB_MAX: [5, REAL32],
  THR_FAILSAFE: [1, INT8],
  THR_FS_VALUE: [950, INT16],
  Q_ENABLE: [0, INT8],
  TKOFF_ALT: [50, REAL32],
  WP_LOITER_RAD: [70, INT16],
  WP_RADIUS: [40, INT16],
};

const QUADPLANE: Table = {
  ...PLANE,
  Q_ENABLE: [1, INT8],
  Q_FRAME_CLASS: [1, INT8],
  Q_FRAME_TYPE: [1, INT8],
  Q_RTL_MODE: [1, INT8],
  Q_TRANSITION_MS: [5000, INT16],
  Q_VFWD_GAIN: [0.05, REAL32],
};

const ROVER: Table = {
  ATC_SPEED_P: [0.2, REAL32],
  ATC_STR_RAT_P: [0.2, REAL32],
  CRUISE_SPEED: [3, REAL32],
  CRUISE_THROTTLE: [50, INT8],
  FS_THR_ENABLE: [1, INT8],
  FS_TIMEOUT: [1.5, REAL32],
  MODE1: [0, INT8],
  MODE2: [4, INT8],
  MODE3: [10, INT8],
  MODE4: [15, INT8],
  MODE5: [11, INT8],
  MODE6: [5, INT8],
  MODE_CH: [8, INT8],
  TURN_RADIUS: [0.9, REAL32],
  WP_RADIUS: [2, REAL32],
  WP_SPEED: [3, REAL32],
};

const SUB: Table = {
  FRAME_CONFIG: [2, INT8],
  FS_LEAK_ENABLE: [1, INT8],
  FS_PRESS_ENABLE: [0, INT8],
  JS_GAIN_DEFAULT: [0.5, REAL32],
  JS_LIGHTS_STEPS: [8, INT16],
  SURFACE_DEPTH: [-10, REAL32],
  WPNAV_SPEED: [150, REAL32],
};

const BETAFLIGHT: Table = {
  ACC_TRIM_PITCH: [0, INT16],
  ACC_TRIM_ROLL: [0, INT16],
  ANGLE_LIMIT: [55, INT16],
  BAT_CAPACITY: [1300, INT16],
  D_PITCH: [34, INT16],
  D_ROLL: [30, INT16],
  GYRO_LPF1: [250, INT16],
  I_PITCH: [84, INT16],
  I_ROLL: [80, INT16],
  MOTOR_POLES: [14, INT8],
  OSD_UNITS: [1, INT8],
  P_PITCH: [47, INT16],
  P_ROLL: [45, INT16],
  P_YAW: [45, INT16],
  MSP_HAS_OSD: [1, INT8],
  MSP_HAS_VTX: [1, INT8],
  VTX_BAND: [5, INT8],
  VTX_CHANNEL: [1, INT8],
  VTX_POWER: [2, INT8],
};

const BY_TYPE: Readonly<Partial<Record<VehicleType, Table>>> = {
  copter: COPTER,
  plane: PLANE,
  vtol: QUADPLANE,
  rover: ROVER,
  boat: ROVER,
  sub: SUB,
};

/** Returns the parameters of a vehicle, sorted by name. */
export function parametersOf(profile: MockProfile, type: VehicleType): MockParameter[] {
  const table: Table = profile.autopilot === ARDUPILOT ? { ...COMMON, ...BY_TYPE[type] } : BETAFLIGHT;
  return Object.keys(table)
    .sort()
    .map((name) => ({ name, value: table[name]![0], type: table[name]![1] }));
}
