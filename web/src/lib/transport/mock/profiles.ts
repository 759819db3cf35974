/** The vehicles of the demo: what they are, where they start, and what they do at first. */

import { MavAutopilot, MavType } from '$generated';

import type { MotionLimits, Point } from './motion';

export interface MockProfile {
  readonly system: number;
  readonly mavType: number;
  /** MAV_AUTOPILOT. */
  readonly autopilot: number;
  readonly limits: MotionLimits;
  readonly start: Point;
  /** Activity when the demo starts. */
  readonly activity: 'parked' | 'mission' | 'circle' | 'pilot';
  /** Mission as points around its start; altitudes above home. */
  readonly mission: readonly Point[];
  /** Volts of the full battery, and its capacity in mAh. */
  readonly battery: { readonly voltage: number; readonly capacity: number };
  /** Reason why it refuses to arm, if it does. */
  readonly armingProblem?: string;
}

export const ARDUPILOT = MavAutopilot.ARDUPILOTMEGA;
export const GENERIC = MavAutopilot.GENERIC;

/** Landiwiese at the shore of Lake Zurich: a meadow for the copter and the rover, water for the boat. */
export const ORIGIN = { latitude: 47.3494, longitude: 8.5363, altitude: 407 } as const;

const COPTER: MotionLimits = { kind: 'hover', speed: 8, climb: 2.5, acceleration: 3, turn: 1.5, radius: 20 };
const PLANE: MotionLimits = { kind: 'wing', speed: 17, climb: 3, acceleration: 3, turn: 0.4, radius: 70 };
const ROVER: MotionLimits = { kind: 'ground', speed: 3, climb: 0, acceleration: 1.5, turn: 0.8, radius: 5 };
const BOAT: MotionLimits = { kind: 'ground', speed: 4, climb: 0, acceleration: 0.6, turn: 0.4, radius: 10 };
const SUB: MotionLimits = { kind: 'hover', speed: 1.5, climb: 0.6, acceleration: 0.5, turn: 0.5, radius: 5 };

const at = (north: number, east: number, up = 0): Point => ({ north, east, up });

/** The fleet of seven. */
export const FLEET: readonly MockProfile[] = [
  {
    system: 1,
    mavType: MavType.QUADROTOR,
    autopilot: ARDUPILOT,
    limits: COPTER,
    start: at(0, 0),
    activity: 'parked',
    mission: [at(60, 40, 25), at(120, 0, 30), at(60, -40, 25)],
    battery: { voltage: 16.8, capacity: 5200 },
  },
  {
    system: 2,
    mavType: MavType.VTOL_FIXEDROTOR,
    autopilot: ARDUPILOT,
    limits: PLANE,
    start: at(220, -60),
    activity: 'mission',
    mission: [at(450, 150, 70), at(300, 650, 80), at(-300, 600, 80), at(-350, 100, 70)],
    battery: { voltage: 25.2, capacity: 12000 },
  },
  {
    system: 3,
    mavType: MavType.FIXED_WING,
    autopilot: ARDUPILOT,
    limits: PLANE,
    start: at(-150, -60),
    activity: 'circle',
    mission: [at(-300, 300, 90), at(-600, 400, 90), at(-600, 0, 90)],
    battery: { voltage: 12.6, capacity: 5000 },
  },
  {
    system: 4,
    mavType: MavType.GROUND_ROVER,
    autopilot: ARDUPILOT,
    limits: ROVER,
    start: at(40, -70),
    activity: 'mission',
    mission: [at(110, -60), at(150, -95), at(60, -110)],
    battery: { voltage: 12.6, capacity: 8000 },
  },
  {
    system: 5,
    mavType: MavType.SURFACE_BOAT,
    autopilot: ARDUPILOT,
    limits: BOAT,
    start: at(0, 380),
    activity: 'mission',
    mission: [at(150, 480), at(60, 620), at(-120, 560), at(-160, 420)],
    battery: { voltage: 14.8, capacity: 20000 },
  },
  {
    system: 6,
    mavType: MavType.SUBMARINE,
    autopilot: ARDUPILOT,
    limits: SUB,
    start: at(-80, 420),
    activity: 'parked',
    mission: [at(-60, 460, -5), at(-110, 470, -8)],
    battery: { voltage: 16.8, capacity: 18000 },
    armingProblem: 'Leak detector triggered',
  },
  {
    system: 7,
    mavType: MavType.QUADROTOR,
    autopilot: GENERIC,
    limits: { ...COPTER, speed: 14, acceleration: 7 },
    start: at(-40, -50),
    activity: 'pilot',
    mission: [],
    battery: { voltage: 25.2, capacity: 1300 },
  },
];

/** Returns the fleet of seven, or any number of vehicles: copters, planes and rovers that fly their missions. */
export function fleetOf(count: number): readonly MockProfile[] {
  if (count <= FLEET.length) return FLEET.slice(0, count);
  return Array.from({ length: count }, (_, index) => {
    const model = FLEET[[2, 1, 3, 4][index % 4]!]!;
    const [north, east] = [(Math.floor(index / 10) - 4.5) * 260, ((index % 10) - 4.5) * 260];
    const mission = [at(80, 0, 60), at(80, 120, 60), at(-60, 120, 60), at(-60, 0, 60)].map((point) =>
      at(north + point.north, east + point.east, model.limits.kind === 'ground' ? 0 : point.up + index),
    );
    return { ...model, system: index + 1, start: at(north, east), activity: 'mission', mission };
  });
}
