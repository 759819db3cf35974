/** Values that instruments show of a vehicle, in the user's units. */
import type { FlightReading, FlightUnits } from '$lib/instruments/flight';
import { bearing, distance, type Place } from '$lib/map/geometry';
import { convert, type Quantity, unitOf } from '$lib/units/units';
import type { Stream } from '$lib/vehicle/streams';
import type { Vehicle, VehicleState } from '$lib/vehicle/Vehicle';

const RADIANS = Math.PI / 180;
/** Slower than this, the direction of travel is noise. */
const MIN_COURSE_SPEED = 0.7;

function shown(value: number | null, quantity: Quantity): number | null {
  return value === null ? null : convert(value, quantity);
}

/** Whether the airspeed counts: fixed wings fly by it. */
export function usesAirSpeed(state: VehicleState): boolean {
  return (state.type === 'plane' || state.type === 'vtol') && state.airSpeed !== null;
}

/** Returns the values of a flight display. */
export function flightReading(state: VehicleState | null): FlightReading {
  if (state === null) return { roll: null, pitch: null, heading: null, speed: null, altitude: null, climb: null };
  const { home, overdue } = state;
  // A horizon or a speed that stands still looks like a quiet flight.
  const isOld = (stream: Stream): boolean => overdue.includes(stream);
  const position = isOld('position') ? null : state.position;
  const speed = usesAirSpeed(state) ? state.airSpeed : state.groundSpeed;
  return {
    roll: isOld('attitude') ? null : state.roll,
    pitch: isOld('attitude') ? null : state.pitch,
    heading: isOld('attitude') ? null : state.heading,
    course: position === null ? null : course(state),
    home: position !== null && home !== null && distance(position, home) > 3 ? bearing(position, home) : null,
    speed: isOld(usesAirSpeed(state) ? 'airspeed' : 'speed') ? null : shown(speed, 'speed'),
    altitude: shown(position?.relativeAltitude ?? position?.altitude ?? null, 'altitude'),
    climb: isOld('speed') ? null : shown(state.climbRate, 'climb'),
  };
}

/** Returns the direction of travel in degrees, or null while the vehicle hardly moves. */
export function course(state: VehicleState): number | null {
  if (state.velocity === null) return null;
  const { north, east } = state.velocity;
  if (Math.hypot(north, east) < MIN_COURSE_SPEED) return null;
  return (Math.atan2(east, north) / RADIANS + 360) % 360;
}

/** Returns the names of the units of a flight display. */
export function flightUnits(state: VehicleState | null): FlightUnits {
  const hasHome = state?.position?.relativeAltitude != null;
  return {
    speedLabel: state !== null && usesAirSpeed(state) ? 'AS' : 'GS',
    speedUnit: unitOf('speed').name,
    altitudeLabel: hasHome || state === null ? 'ALT' : 'AMSL',
    altitudeUnit: unitOf('altitude').name,
    fullClimb: convert(10, 'climb'),
  };
}

/** Returns the bearing from a place to another in whole degrees of three digits. */
export function bearingText(from: Place, to: Place): string {
  return String(Math.round(bearing(from, to)) % 360).padStart(3, '0');
}

/** Returns the distance to home in metres, or null. */
export function homeDistance(state: VehicleState): number | null {
  return state.position === null || state.home === null ? null : distance(state.position, state.home);
}

/** Whether a vehicle moves on the ground or on water: it needs no takeoff. */
export function isOnSurface({ type }: VehicleState): boolean {
  return type === 'rover' || type === 'boat';
}

/** Whether a vehicle can be sent to places: armed, and in the air if it flies. */
export function isUnderWay(state: VehicleState): boolean {
  return state.armed === true && (state.inAir !== false || isOnSurface(state) || state.type === 'sub');
}

/** Which vehicles an action is sent to: of several chosen ones, only those that can do it now. */
export const IS_FOR = {
  arm: ({ state }) => state.armed !== true,
  disarm: ({ state }) => state.armed === true && state.inAir !== true,
  takeoff: ({ state, capabilities }) =>
    state.armed === true && state.inAir !== true && capabilities.takeoff !== false && !isOnSurface(state),
  goto: ({ state, capabilities }) => isUnderWay(state) && capabilities.goto !== false,
  orbit: ({ state, capabilities }) => isUnderWay(state) && capabilities.orbit !== false,
  lookAt: ({ state, capabilities }) => state.alive && capabilities.roi !== false,
  mission: ({ state, capabilities }) => state.alive && capabilities.mission !== false,
  armed: ({ state }) => state.armed === true,
  all: () => true,
} satisfies Readonly<Record<string, (vehicle: Pick<Vehicle, 'state' | 'capabilities'>) => boolean>>;
