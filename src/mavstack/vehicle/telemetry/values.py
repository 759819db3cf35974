"""Values that a vehicle reports, in SI units and degrees, the same for every firmware.

None means that the vehicle does not know the value, or reports that it does not. Directions are degrees
clockwise from north; north, east and down are the axes of the local frame (NED).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, degrees, hypot
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from mavstack.dialects import common

Vector: TypeAlias = "tuple[float, float, float]"

_FIX_3D = 3


@dataclass(frozen=True, slots=True)
class Position:
    """A global position.

    Attributes:
        latitude: Degrees, positive to the north.
        longitude: Degrees, positive to the east.
        altitude: Metres above mean sea level.
        relative_altitude: Metres above home.
        heading: The direction in which the vehicle points, 0 to 360 degrees.
    """

    latitude: float
    longitude: float
    altitude: float | None = None
    relative_altitude: float | None = None
    heading: float | None = None


@dataclass(frozen=True, slots=True)
class LocalPosition:
    """A position in metres from the origin of the vehicle's local frame (NED)."""

    north: float
    east: float
    down: float


@dataclass(frozen=True, slots=True)
class Velocity:
    """A velocity over ground in m/s (NED)."""

    north: float
    east: float
    down: float

    @property
    def ground_speed(self) -> float:
        """The horizontal speed in m/s."""
        return hypot(self.north, self.east)


@dataclass(frozen=True, slots=True)
class Attitude:
    """An attitude in degrees (yaw from -180 to 180), and its rates in degrees per second."""

    roll: float
    pitch: float
    yaw: float
    roll_rate: float | None = None
    pitch_rate: float | None = None
    yaw_rate: float | None = None

    @property
    def heading(self) -> float:
        """The yaw as a heading of 0 to 360 degrees."""
        return self.yaw % 360.0


@dataclass(frozen=True, slots=True)
class VfrHud:
    """The values of a head-up display: speeds in m/s, throttle in percent.

    Attributes:
        airspeed: Speed through the air, in m/s.
        ground_speed: Horizontal speed over ground, in m/s.
        climb: Vertical speed, in m/s, positive up.
        throttle: Throttle, in percent.
    """

    airspeed: float | None
    ground_speed: float | None
    climb: float | None
    throttle: float | None


@dataclass(frozen=True, slots=True)
class Gps:
    """The state of the satellite navigation receiver.

    Attributes:
        fix: The GPS_FIX_TYPE.
        satellites: The number of visible satellites.
        hdop: Horizontal dilution of precision.
        vdop: Vertical dilution of precision.
        latitude: Degrees; None without a fix.
        longitude: Degrees; None without a fix.
        altitude: Metres above mean sea level; None without a fix.
        ground_speed: Metres per second.
        course: The direction of motion over ground, in degrees.
        heading: The direction in which the vehicle points, in degrees, from a receiver with two antennas.
        horizontal_accuracy: Metres.
        vertical_accuracy: Metres.
    """

    fix: common.GpsFixType | int
    satellites: int | None = None
    hdop: float | None = None
    vdop: float | None = None
    latitude: float | None = None
    longitude: float | None = None
    altitude: float | None = None
    ground_speed: float | None = None
    course: float | None = None
    heading: float | None = None
    horizontal_accuracy: float | None = None
    vertical_accuracy: float | None = None

    @property
    def has_fix(self) -> bool:
        """True if the receiver has a fix in three dimensions."""
        return self.fix >= _FIX_3D


@dataclass(frozen=True, slots=True)
class Battery:
    """The state of a battery.

    Attributes:
        id: The number of the battery, from 0.
        voltage: Volts.
        current: Amperes.
        remaining: The charge that is left, in percent.
        consumed: The charge that was drawn, in mAh.
        temperature: Degrees Celsius.
        cells: The voltage of each cell, in volts; empty if only the sum is reported.
        time_remaining: Seconds until the battery is empty.
        charge_state: The MAV_BATTERY_CHARGE_STATE.
        faults: The MAV_BATTERY_FAULT flags.
    """

    id: int = 0
    voltage: float | None = None
    current: float | None = None
    remaining: float | None = None
    consumed: float | None = None
    temperature: float | None = None
    cells: tuple[float, ...] = ()
    time_remaining: float | None = None
    charge_state: common.MavBatteryChargeState | int | None = None
    faults: common.MavBatteryFault | int = 0


@dataclass(frozen=True, slots=True)
class HomePosition:
    """The position of home: degrees, and metres above mean sea level."""

    latitude: float
    longitude: float
    altitude: float


@dataclass(frozen=True, slots=True)
class Rc:
    """The radio control input.

    Attributes:
        channels: The pulse of each channel in microseconds, from channel 1; None for an unused channel.
        rssi: The signal strength, 0 to 254.
    """

    channels: tuple[int | None, ...]
    rssi: int | None = None


@dataclass(frozen=True, slots=True)
class Wind:
    """The velocity of the air in m/s (NED): the direction in which it moves."""

    north: float
    east: float
    down: float | None = None

    @property
    def speed(self) -> float:
        """The horizontal wind speed in m/s."""
        return hypot(self.north, self.east)

    @property
    def direction(self) -> float:
        """The direction from which the wind blows, in degrees, as in a weather report."""
        return degrees(atan2(-self.east, -self.north)) % 360.0


@dataclass(frozen=True, slots=True)
class Imu:
    """The readings of the inertial sensors, in the axes of the body (forward, right, down).

    Attributes:
        acceleration: Metres per second squared.
        rotation: Degrees per second.
        magnetic_field: Gauss.
        temperature: Degrees Celsius.
    """

    acceleration: Vector
    rotation: Vector
    magnetic_field: Vector | None = None
    temperature: float | None = None


@dataclass(frozen=True, slots=True)
class Odometry:
    """An odometry estimate.

    Attributes:
        frame: The MAV_FRAME of `position`.
        child_frame: The MAV_FRAME of `velocity` and `rotation`.
        position: Metres.
        quaternion: The attitude as w, x, y, z.
        velocity: Metres per second.
        rotation: Degrees per second.
        quality: Percent.
        resets: The number of estimator resets.
    """

    frame: common.MavFrame | int
    child_frame: common.MavFrame | int
    position: Vector | None
    quaternion: tuple[float, float, float, float] | None
    velocity: Vector | None
    rotation: Vector | None
    quality: float | None = None
    resets: int = 0


@dataclass(frozen=True, slots=True)
class StatusText:
    """A status text (STATUSTEXT).

    Attributes:
        time: The time of receipt, in Unix seconds.
        severity: The MAV_SEVERITY.
        text: The whole text, joined from its chunks.
        component: The component id of the sender.
        has_event: True if the component sends an event too, as PX4 marks it; see `Vehicle.events`.
    """

    time: float
    severity: common.MavSeverity | int
    text: str
    component: int
    has_event: bool = False


@dataclass(frozen=True, slots=True)
class Esc:
    """The state of a motor controller.

    Attributes:
        rpm: Revolutions per minute.
        voltage: Volts.
        current: Amperes.
        temperature: Degrees Celsius.
        online: True if the autopilot receives its telemetry.
        failures: The ESC_FAILURE_FLAGS.
        errors: The number of errors that it counted.
    """

    rpm: float | None = None
    voltage: float | None = None
    current: float | None = None
    temperature: float | None = None
    online: bool | None = None
    failures: common.EscFailureFlags | int = 0
    errors: int | None = None


@dataclass(frozen=True, slots=True)
class Generator:
    """The state of an onboard generator.

    Attributes:
        status: The MAV_GENERATOR_STATUS_FLAG flags.
        rpm: Revolutions per minute.
        power: The power that it generates, in watts.
        voltage: The voltage of its bus, in volts.
        battery_current: The current into the battery, in amperes; negative while it supplies the vehicle.
        load_current: The current into the vehicle, in amperes.
        temperature: Degrees Celsius.
        rectifier_temperature: Degrees Celsius.
        runtime: Seconds that it has run.
        time_until_maintenance: Seconds until its next maintenance; negative: overdue.
    """

    status: common.MavGeneratorStatusFlag | int = 0
    rpm: float | None = None
    power: float | None = None
    voltage: float | None = None
    battery_current: float | None = None
    load_current: float | None = None
    temperature: float | None = None
    rectifier_temperature: float | None = None
    runtime: float | None = None
    time_until_maintenance: float | None = None


@dataclass(frozen=True, slots=True)
class Engine:
    """The state of a combustion engine with electronic fuel injection.

    Attributes:
        healthy: True if its control unit reports no fault.
        rpm: Revolutions per minute.
        load: Percent.
        throttle: The position of the throttle, in percent.
        fuel_consumed: Cubic centimetres.
        fuel_flow: Cubic centimetres per minute.
        cylinder_temperature: Degrees Celsius.
        exhaust_temperature: Degrees Celsius.
        intake_temperature: Degrees Celsius.
        intake_pressure: Kilopascals.
    """

    healthy: bool = False
    rpm: float | None = None
    load: float | None = None
    throttle: float | None = None
    fuel_consumed: float | None = None
    fuel_flow: float | None = None
    cylinder_temperature: float | None = None
    exhaust_temperature: float | None = None
    intake_temperature: float | None = None
    intake_pressure: float | None = None


@dataclass(frozen=True, slots=True)
class Modem:
    """The state of a mobile network modem.

    Attributes:
        id: The number of the modem, from 1; 0 if it has none.
        status: The CELLULAR_STATUS_FLAG.
        failure: The CELLULAR_NETWORK_FAILED_REASON.
        radio: The CELLULAR_NETWORK_RADIO_TYPE.
        quality: The quality of the signal, in percent.
        country: The mobile country code.
        network: The mobile network code.
        received_level: The level of the received signal, in dBm.
    """

    id: int = 0
    status: common.CellularStatusFlag | int = 0
    failure: common.CellularNetworkFailedReason | int = 0
    radio: common.CellularNetworkRadioType | int = 0
    quality: float | None = None
    country: int | None = None
    network: int | None = None
    received_level: float | None = None
