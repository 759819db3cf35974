/**
 * Kinematic models of vehicles: metres north, east and up of the fleet's origin, radians, seconds.
 *
 * They fly as a picture of the real thing does: speeds and turns have limits, there are no forces.
 */

export interface Point {
  readonly north: number;
  readonly east: number;
  readonly up: number;
}

/** Hovering vehicles stop at a point, winged ones circle it, ground vehicles stop but do not climb. */
export type MotionKind = 'hover' | 'wing' | 'ground';

/** Demand of one step: fly to a point, circle one, or keep a velocity. */
export type Demand =
  | { readonly kind: 'stay' }
  | { readonly kind: 'point'; readonly point: Point }
  | { readonly kind: 'circle'; readonly center: Point; readonly radius: number }
  | {
      readonly kind: 'velocity';
      readonly north: number;
      readonly east: number;
      readonly up: number;
      readonly yawRate: number;
    };

export interface MotionLimits {
  readonly kind: MotionKind;
  readonly speed: number;
  readonly climb: number;
  readonly acceleration: number;
  /** Rad/s. */
  readonly turn: number;
  /** Radius of circles of winged vehicles. */
  readonly radius: number;
}

const GRAVITY = 9.81;
const CIRCLE_GAIN = 0.02;

export const clamp = (value: number, limit: number): number => Math.min(Math.max(value, -limit), limit);

/** Returns an angle in -π … π. */
export function wrap(angle: number): number {
  return angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
}

export class Motion {
  north: number;
  east: number;
  up: number;
  velocityNorth = 0;
  velocityEast = 0;
  velocityUp = 0;
  yaw: number;
  roll = 0;
  pitch = 0;
  yawRate = 0;
  /** Speed that a command asked for, or the usual one. */
  speed: number;
  limits: MotionLimits;

  constructor(limits: MotionLimits, start: Point, yaw = 0) {
    this.limits = limits;
    this.speed = limits.speed;
    this.north = start.north;
    this.east = start.east;
    this.up = start.up;
    this.yaw = yaw;
  }

  get groundSpeed(): number {
    return Math.hypot(this.velocityNorth, this.velocityEast);
  }

  distanceTo(point: Point): number {
    return Math.hypot(point.north - this.north, point.east - this.east);
  }

  /** Stands still at once. */
  rest(): void {
    this.velocityNorth = this.velocityEast = this.velocityUp = this.roll = this.pitch = this.yawRate = 0;
  }

  step(dt: number, demand: Demand): void {
    const before = this.yaw;
    if (this.limits.kind === 'hover') this.hover(dt, demand);
    else this.drive(dt, demand);
    this.north += this.velocityNorth * dt;
    this.east += this.velocityEast * dt;
    this.up += this.velocityUp * dt;
    this.yawRate = wrap(this.yaw - before) / dt;
  }

  private hover(dt: number, demand: Demand): void {
    const [north, east, up] = this.wantedVelocity(demand);
    const maxChange = this.limits.acceleration * dt;
    const [changeNorth, changeEast] = [
      clamp(north - this.velocityNorth, maxChange),
      clamp(east - this.velocityEast, maxChange),
    ];
    this.velocityNorth += changeNorth;
    this.velocityEast += changeEast;
    this.velocityUp += clamp(up - this.velocityUp, 2 * dt);
    // Leans into acceleration and against the drag of its speed.
    const [forceNorth, forceEast] = [
      changeNorth / dt / GRAVITY + this.velocityNorth / 60,
      changeEast / dt / GRAVITY + this.velocityEast / 60,
    ];
    const [cos, sin] = [Math.cos(this.yaw), Math.sin(this.yaw)];
    const smooth = Math.min(1, 4 * dt);
    this.pitch += (-(forceNorth * cos + forceEast * sin) - this.pitch) * smooth;
    this.roll += (forceEast * cos - forceNorth * sin - this.roll) * smooth;
    if (demand.kind === 'velocity') this.yaw = wrap(this.yaw + demand.yawRate * dt);
    else if (this.groundSpeed > 1) this.turnTo(Math.atan2(this.velocityEast, this.velocityNorth), dt);
  }

  private wantedVelocity(demand: Demand): [number, number, number] {
    if (demand.kind === 'velocity') return [demand.north, demand.east, clamp(demand.up, this.limits.climb)];
    if (demand.kind === 'stay') return [0, 0, 0];
    if (demand.kind === 'circle') {
      const course = this.circleCourse(demand.center, demand.radius);
      const climb = clamp(demand.center.up - this.up, this.limits.climb);
      return [this.speed * Math.cos(course), this.speed * Math.sin(course), climb];
    }
    const { point } = demand;
    const distance = this.distanceTo(point);
    // Slows down so that it can stop there.
    const speed = Math.min(this.speed, Math.sqrt(this.limits.acceleration * distance), distance * 0.8);
    const scale = distance > 0.01 ? speed / distance : 0;
    const climb = clamp(point.up - this.up, this.limits.climb);
    return [(point.north - this.north) * scale, (point.east - this.east) * scale, climb];
  }

  private drive(dt: number, demand: Demand): void {
    const isWing = this.limits.kind === 'wing';
    let [speed, course, up] = [0, this.yaw, this.up];
    if (demand.kind === 'velocity') {
      speed =
        Math.hypot(demand.north, demand.east) *
        Math.sign(demand.north * Math.cos(this.yaw) + demand.east * Math.sin(this.yaw));
      course = this.yaw + demand.yawRate;
      up = this.up + demand.up;
    } else if (demand.kind === 'circle') {
      [speed, course, up] = [this.speed, this.circleCourse(demand.center, demand.radius), demand.center.up];
    } else if (demand.kind === 'point') {
      const distance = this.distanceTo(demand.point);
      speed = isWing ? this.speed : Math.min(this.speed, distance * 0.8);
      course = Math.atan2(demand.point.east - this.east, demand.point.north - this.north);
      up = demand.point.up;
    } else if (isWing && this.up > 1) {
      speed = this.speed;
    }
    const now = this.forwardSpeed + clamp(speed - this.forwardSpeed, this.limits.acceleration * dt);
    const before = this.yaw;
    if (Math.abs(now) > 0.2) this.turnTo(course, dt);
    this.velocityNorth = now * Math.cos(this.yaw);
    this.velocityEast = now * Math.sin(this.yaw);
    const smooth = Math.min(1, 3 * dt);
    if (!isWing) return;
    const climb = clamp((up - this.up) * 0.5, this.limits.climb);
    this.velocityUp += (climb - this.velocityUp) * smooth;
    const turn = wrap(this.yaw - before) / dt;
    this.roll += (Math.atan((turn * now) / GRAVITY) - this.roll) * smooth;
    this.pitch += (Math.atan2(this.velocityUp, Math.max(now, 5)) + 0.03 - this.pitch) * smooth;
  }

  private get forwardSpeed(): number {
    return this.velocityNorth * Math.cos(this.yaw) + this.velocityEast * Math.sin(this.yaw);
  }

  private circleCourse(center: Point, radius: number): number {
    const direction = Math.sign(radius) || 1;
    const bearing = Math.atan2(this.east - center.east, this.north - center.north);
    const error = this.distanceTo(center) - Math.abs(radius);
    return wrap(bearing + direction * (Math.PI / 2 + Math.atan(error * (CIRCLE_GAIN + 1 / Math.abs(radius)))));
  }

  private turnTo(course: number, dt: number): void {
    this.yaw = wrap(this.yaw + clamp(wrap(course - this.yaw), this.limits.turn * dt));
  }
}
