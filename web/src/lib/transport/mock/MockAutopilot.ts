/** The autopilot of one vehicle of the demo: arming, modes, guided flight and missions over its motion. */

import { MavCmd, MavSeverity } from '$generated';
import type { PlanItem } from '$lib/vehicle/Vehicle';
import type { VehicleType } from '$lib/vehicle/Vehicle';
import { ardupilotModes, vehicleTypeOf } from '$lib/vehicle/vehicleType';

import { behaviourOf, firstMode } from './modes';
import { Motion, type Demand, type Point } from './motion';
import { toPoint } from './place';
import { ARDUPILOT, type MockProfile } from './profiles';

const RETURN_ALTITUDE = 15;
const WING_RETURN_ALTITUDE = 60;
/** Turns or seconds that an item of the mission has still to be flown. */
const SECONDS_PER_TURN = 30;
const STICK_TIMEOUT = 1;

/** Severity and text for the ground station. */
export type Report = (severity: number, text: string) => void;

export class MockAutopilot {
  readonly profile: MockProfile;
  readonly type: VehicleType;
  readonly motion: Motion;
  readonly modes: Readonly<Record<string, number>>;
  armed = false;
  mode: string;
  /** Items as in the vehicle: item 0 is home. */
  mission: PlanItem[] = [];
  current = 0;
  home: Point;
  /** The region of interest; null: none. */
  lookedAt: Point | null = null;
  remaining = 1;
  /** Radius of circles in metres, negative: counter-clockwise. */
  radius: number;
  /** Items that were reached since the last look. */
  readonly reached: number[] = [];
  private readonly report: Report;
  private target: Point | null = null;
  private itemTime = 0;
  private jumps = new Map<number, number>();
  private sticks = { x: 0, y: 0, z: 0, r: 0, age: Infinity };
  private time = 0;

  constructor(profile: MockProfile, report: Report) {
    this.profile = profile;
    this.report = report;
    this.type = vehicleTypeOf(profile.mavType);
    this.motion = new Motion(profile.limits, profile.start);
    this.home = profile.start;
    this.radius = profile.limits.radius;
    this.modes = profile.autopilot === ARDUPILOT ? ardupilotModes(this.type) : {};
    this.mode = profile.autopilot === ARDUPILOT ? firstMode(this.type) : 'ANGLE';
  }

  get isGround(): boolean {
    return this.profile.limits.kind === 'ground';
  }

  get landed(): boolean {
    if (this.isGround || this.type === 'sub') return !this.armed;
    return this.motion.up <= 0.1;
  }

  /** Returns the reason why it does not arm, or null. */
  arm(force: boolean): string | null {
    const problem = this.profile.armingProblem;
    if (problem !== undefined && !force) return `PreArm: ${problem}`;
    if (['return', 'land'].includes(behaviourOf(this.mode)) && !this.armed && !force) {
      return `Arm: ${this.mode} mode not armable`;
    }
    if (!this.armed) this.report(MavSeverity.INFO, 'Arming motors');
    this.armed = true;
    return null;
  }

  /** Returns the reason why it does not disarm, or null. */
  disarm(force: boolean): string | null {
    if (!this.landed && this.motion.up > 0.5 && !force) return 'Disarm: vehicle is flying';
    if (this.armed) this.report(MavSeverity.INFO, 'Disarming motors');
    this.armed = false;
    this.target = null;
    this.motion.rest();
    return null;
  }

  enter(mode: string): void {
    if (mode === this.mode) return;
    this.mode = mode;
    const { north, east, up } = this.motion;
    this.target = { north, east, up };
    if (behaviourOf(mode) === 'mission') this.start(this.current);
  }

  /** Returns the reason why it does not take off, or null. */
  takeoff(altitude: number): string | null {
    if (this.isGround || this.type === 'sub') return 'Takeoff: not supported by this vehicle';
    if (!this.armed) return 'Takeoff: vehicle is not armed';
    if (behaviourOf(this.mode) !== 'guided') return `Takeoff: not possible in mode ${this.mode}`;
    const { north, east } = this.motion;
    this.target = { north, east, up: altitude };
    return null;
  }

  /** Goes to a point; a wing circles it with a radius in metres, counter-clockwise if it is negative. */
  goto(point: Point, radius = this.profile.limits.radius): boolean {
    if (behaviourOf(this.mode) !== 'guided') return false;
    this.target = point;
    this.radius = radius;
    return true;
  }

  setSpeed(speed: number): void {
    this.motion.speed = Math.min(speed, this.profile.limits.speed * 1.5);
  }

  /** Goes to an item of the mission. */
  start(seq: number): void {
    this.current = Math.min(Math.max(seq, 1), Math.max(this.mission.length - 1, 0));
    this.itemTime = 0;
  }

  /** Takes the sticks of MANUAL_CONTROL: -1 … 1, the throttle 0 … 1. */
  steer(x: number, y: number, z: number, r: number): void {
    this.sticks = { x, y, z, r, age: 0 };
  }

  step(dt: number): void {
    this.time += dt;
    this.sticks.age += dt;
    if (!this.armed) {
      if (this.motion.groundSpeed > 0 || this.motion.velocityUp !== 0) this.motion.rest();
      return;
    }
    this.remaining = Math.max(0, this.remaining - (dt * this.consumption) / this.profile.battery.capacity);
    this.motion.step(dt, this.demand(dt));
    if (this.type !== 'sub') this.motion.up = Math.max(0, this.motion.up);
    else this.motion.up = Math.min(0, this.motion.up);
    if (behaviourOf(this.mode) === 'land' && this.motion.up <= 0.05) this.disarm(true);
  }

  /** Current in A. */
  get amperes(): number {
    if (!this.armed) return 0.6;
    const climb = Math.max(0, this.motion.velocityUp);
    return (this.isGround ? 2 + this.motion.groundSpeed : 11) + climb * 2 + this.motion.groundSpeed * 0.15;
  }

  private get consumption(): number {
    return (this.amperes * 1000) / 3600;
  }

  private demand(dt: number): Demand {
    if (this.profile.activity === 'pilot') return this.piloted();
    switch (behaviourOf(this.mode)) {
      case 'guided':
        return this.guided();
      case 'mission':
        return this.fly(dt);
      case 'return':
        return this.returning();
      case 'land':
        return this.landing();
      case 'surface':
        return { kind: 'point', point: { ...this.here, up: 0 } };
      case 'circle':
        return this.around(this.target ?? this.here, this.radius);
      case 'stay':
        return this.loiter();
      default:
        return this.manual();
    }
  }

  private get here(): Point {
    const { north, east, up } = this.motion;
    return { north, east, up };
  }

  private around(center: Point, radius: number): Demand {
    return { kind: 'circle', center, radius };
  }

  private loiter(): Demand {
    if (this.sticks.age < STICK_TIMEOUT) return this.manual();
    const target = this.target ?? this.here;
    if (this.profile.limits.kind === 'wing')
      return this.motion.up > 5 ? this.around(target, this.profile.limits.radius) : { kind: 'stay' };
    return { kind: 'point', point: target };
  }

  private guided(): Demand {
    if (this.target === null) return { kind: 'stay' };
    return this.toward(this.target);
  }

  /** Flies to a point; a winged vehicle circles it from then on. */
  private toward(point: Point): Demand {
    const { kind } = this.profile.limits;
    const isNear = this.motion.distanceTo(point) < Math.abs(this.radius) * 1.5;
    if (kind === 'wing' && isNear && this.motion.up > 3) return this.around(point, this.radius);
    return { kind: 'point', point };
  }

  private returning(): Demand {
    const { kind } = this.profile.limits;
    const up = this.isGround || this.type === 'sub' ? 0 : kind === 'wing' ? WING_RETURN_ALTITUDE : RETURN_ALTITUDE;
    const above = { ...this.home, up: Math.max(up, Math.min(this.motion.up, 120)) };
    if (kind === 'wing') return this.toward(above);
    if (this.motion.distanceTo(this.home) > 2) return { kind: 'point', point: above };
    if (this.isGround || this.type === 'sub') return { kind: 'stay' };
    this.enter('LAND');
    return this.landing();
  }

  private landing(): Demand {
    const speed = this.motion.up > 10 ? 2 : 0.7;
    return { kind: 'velocity', north: 0, east: 0, up: -speed, yawRate: 0 };
  }

  private manual(): Demand {
    if (this.sticks.age > STICK_TIMEOUT) return { kind: 'stay' };
    const { x, y, z, r } = this.sticks;
    const { speed, climb } = this.profile.limits;
    const [cos, sin] = [Math.cos(this.motion.yaw), Math.sin(this.motion.yaw)];
    const [north, east] = [(x * cos - y * sin) * speed, (x * sin + y * cos) * speed];
    return { kind: 'velocity', north, east, up: (z - 0.5) * 2 * climb, yawRate: (this.isGround ? y : r) * 1.5 };
  }

  /** A pilot with a radio flies figures of eight. */
  private piloted(): Demand {
    const phase = this.time / 6;
    const { north, east } = this.profile.start;
    const point = {
      north: north + 35 * Math.sin(phase),
      east: east + 25 * Math.sin(2 * phase),
      up: 12 + 6 * Math.sin(phase * 1.7),
    };
    return { kind: 'point', point };
  }

  private fly(dt: number): Demand {
    for (let skipped = 0; skipped <= this.mission.length; skipped += 1) {
      const item = this.mission[this.current];
      if (item === undefined || this.mission.length < 2) return this.loiterAtEnd();
      const demand = this.flyItem(item, dt);
      if (demand !== null) return demand;
      this.reached.push(this.current);
      if (this.mission[this.current] === item) this.current += 1;
      this.itemTime = 0;
      if (this.current < this.mission.length) continue;
      this.report(MavSeverity.INFO, 'Mission complete');
      this.current = this.mission.length - 1;
      this.enter(this.type === 'vtol' || this.type === 'plane' ? 'RTL' : this.isGround ? 'HOLD' : 'LOITER');
      return this.loiterAtEnd();
    }
    return this.loiterAtEnd();
  }

  private loiterAtEnd(): Demand {
    return this.profile.limits.kind === 'wing' && this.motion.up > 5
      ? this.around(this.here, this.profile.limits.radius)
      : { kind: 'stay' };
  }

  /** Returns the demand of an item, or null if it is done. */
  private flyItem(item: PlanItem, dt: number): Demand | null {
    const point = toPoint(item, this.home, this.here);
    this.itemTime += dt;
    switch (item.command) {
      case MavCmd.NAV_WAYPOINT:
        return this.flyTo(point, item.params[0] ?? 0);
      case MavCmd.NAV_TAKEOFF:
      case MavCmd.NAV_VTOL_TAKEOFF:
        return this.motion.up > point.up - 1
          ? null
          : { kind: 'point', point: { ...this.aheadOf(point), up: point.up } };
      case MavCmd.NAV_LOITER_UNLIM:
        return this.toward(point);
      case MavCmd.NAV_LOITER_TIME:
        return this.itemTime > (item.params[0] ?? 0) + 20 ? null : this.toward(point);
      case MavCmd.NAV_LOITER_TURNS:
        return this.itemTime > (item.params[0] ?? 1) * SECONDS_PER_TURN
          ? null
          : this.around(point, this.profile.limits.radius);
      case MavCmd.NAV_RETURN_TO_LAUNCH:
        this.enter(this.modes.RTL === undefined ? 'HOLD' : 'RTL');
        return { kind: 'stay' };
      case MavCmd.NAV_LAND:
      case MavCmd.NAV_VTOL_LAND:
        return this.land(point);
      default:
        this.doItem(item);
        return null;
    }
  }

  private land(point: Point): Demand {
    if (this.motion.distanceTo(point) > 3)
      return { kind: 'point', point: { ...point, up: Math.max(this.motion.up, 5) } };
    this.enter(this.modes.LAND === undefined ? 'QLAND' : 'LAND');
    return this.landing();
  }

  private flyTo(point: Point, seconds: number): Demand | null {
    const near = { wing: 40, ground: 2, hover: 2 }[this.profile.limits.kind];
    if (this.motion.distanceTo(point) > near) {
      this.itemTime = 0;
      return { kind: 'point', point };
    }
    return this.itemTime > seconds ? null : { kind: 'point', point };
  }

  /** Winged vehicles climb on their way, others at their place. */
  private aheadOf(point: Point): Point {
    if (this.profile.limits.kind !== 'wing') return this.here;
    return this.motion.distanceTo(point) > 20 ? point : { north: point.north + 300, east: point.east, up: point.up };
  }

  private doItem(item: PlanItem): void {
    if (item.command === MavCmd.DO_CHANGE_SPEED) this.setSpeed(item.params[1] ?? this.motion.speed);
    if (item.command !== MavCmd.DO_JUMP) return;
    const [target, limit] = [item.params[0] ?? 1, item.params[1] ?? 0];
    const count = (this.jumps.get(this.current) ?? 0) + 1;
    this.jumps.set(this.current, count);
    if (limit < 0 || count <= limit) this.current = target;
  }
}
