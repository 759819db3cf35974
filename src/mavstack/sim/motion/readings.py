"""Values that can be read of a body: named tuples of plain floats."""

from __future__ import annotations

from typing import NamedTuple

#: GPS_FIX_TYPE without a position, and with a position.
NO_FIX, FIX_3D = 1, 3
#: Dilution of precision for each metre of expected position error.
DILUTION = 0.78
#: Reported error of an unknown position, in metres.
UNKNOWN_ERROR = 99.99


class Motion(NamedTuple):
    """Position, velocity, acceleration, attitude and body rates: metres from the frame's origin, radians."""

    north: float
    east: float
    down: float
    velocity_north: float
    velocity_east: float
    velocity_down: float
    acceleration_north: float
    acceleration_east: float
    acceleration_down: float
    roll: float
    pitch: float
    yaw: float
    roll_rate: float
    pitch_rate: float
    yaw_rate: float


class AttitudeSetpoint(NamedTuple):
    """Attitude and body rates that the control loops ask for: radians and rad/s."""

    roll: float
    pitch: float
    yaw: float
    roll_rate: float
    pitch_rate: float
    yaw_rate: float


class Wind(NamedTuple):
    """Velocity of the air at a body, in m/s."""

    north: float
    east: float
    down: float


class BatteryState(NamedTuple):
    """Volts, amperes, mAh, state of charge (0 to 1), degrees Celsius, capacity in mAh, cells."""

    voltage: float
    current: float
    consumed: float
    remaining: float
    temperature: float
    capacity: float
    cells: int


class SensorReadings(NamedTuple):
    """Sensor readings: rad/s, m/s2 (specific force, body axes), gauss, hPa, degrees, metres."""

    gyro_x: float
    gyro_y: float
    gyro_z: float
    acceleration_x: float
    acceleration_y: float
    acceleration_z: float
    magnetic_x: float
    magnetic_y: float
    magnetic_z: float
    pressure: float
    differential_pressure: float
    temperature: float
    distance: float
    heading: float
    gps_latitude: float
    gps_longitude: float
    gps_altitude: float
    gps_velocity_north: float
    gps_velocity_east: float
    gps_velocity_down: float
    gps_fix: int
    gps_satellites: int
    gps_eph: float
    gps_epv: float


class GpsReport(NamedTuple):
    """Report of a receiver outside the simulation, with the fields of `SensorReadings` that it replaces."""

    gps_latitude: float = 0.0
    gps_longitude: float = 0.0
    gps_altitude: float = 0.0
    gps_velocity_north: float = 0.0
    gps_velocity_east: float = 0.0
    gps_velocity_down: float = 0.0
    gps_fix: int = NO_FIX
    gps_satellites: int = 0
    gps_eph: float = UNKNOWN_ERROR
    gps_epv: float = UNKNOWN_ERROR


class Aid(NamedTuple):
    """An estimate from outside the autopilot: metres from the frame's origin, radians; None: not used."""

    horizontal: tuple[float, float] | None = None
    down: float | None = None
    yaw: float | None = None


class EstimateHealth(NamedTuple):
    """Parts of the estimate that are reliable, and the sensors' test ratios (1 is the gate)."""

    attitude: bool
    heading: bool
    velocity: bool
    horizontal: bool
    vertical: bool
    velocity_variance: float
    position_variance: float
    height_variance: float
    compass_variance: float


class Limits(NamedTuple):
    """Limits of a body that an autopilot's parameters set: m/s, m/s2, radians, rad/s, metres."""

    speed: float
    climb: float
    sink: float
    tilt: float
    acceleration: float
    turn_rate: float
    loiter_radius: float
    airspeed_cruise: float
    airspeed_min: float
    airspeed_max: float
