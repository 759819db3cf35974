/** The effect of the motors on the compass, while the pilot raises the throttle. */

export interface CompassMotorPoint {
  /** Percent. */
  readonly throttle: number;
  /** Amperes. */
  readonly current: number;
  /** Percent of the earth's field at full throttle. */
  readonly interference: number;
}

/** Reads COMPASSMOT_STATUS, whose throttle is in tenths of a percent. */
export function readCompassMotor(fields: Readonly<Record<string, unknown>>): CompassMotorPoint {
  return {
    throttle: Number(fields.throttle) / 10,
    current: Number(fields.current),
    interference: Number(fields.interference),
  };
}

/** Returns the points in the order of their throttle, with the latest one for each percent. */
export function withPoint(points: readonly CompassMotorPoint[], point: CompassMotorPoint): CompassMotorPoint[] {
  const others = points.filter((each) => Math.round(each.throttle) !== Math.round(point.throttle));
  return [...others, point].sort((one, other) => one.throttle - other.throttle);
}
