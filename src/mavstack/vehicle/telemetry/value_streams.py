"""Streams of the values that a vehicle reports, and the wait for first values: methods of `Vehicle`.

`rate` is the rate to request while the stream is open, in hertz; None requests a default rate, and only
for messages that the vehicle does not send by itself. Reading a stream raises `CommandDenied` if the
vehicle refuses to send the value.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import InvalidArgumentError
from mavstack.services import DEFAULT_WAIT_TIMEOUT
from mavstack.vehicle.telemetry import readers
from mavstack.vehicle.telemetry.value_stream import ValueStream, wait_for_values

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from mavstack.dialects import Message
    from mavstack.vehicle.telemetry import values
    from mavstack.vehicle.telemetry.telemetry import Telemetry
    from mavstack.vehicle.vehicle import Vehicle

#: The rate of HOME_POSITION in hertz, which changes rarely.
_HOME_RATE: Final = 0.5
#: The values that most programs need before a flight.
_FIRST_VALUES: Final = ("position", "battery", "gps", "home")


async def wait_for_telemetry(
    vehicle: Vehicle, *names: str, timeout: float | None = DEFAULT_WAIT_TIMEOUT
) -> None:
    """Wait until values were received, and request the messages that hold them.

    Args:
        names: The names of properties, such as "position" and "battery"; none: position, battery, gps
            and home.
        timeout: Seconds to wait; None waits for ever.

    Raises:
        InvalidArgumentError: There is no stream of that name.
        MessageTimeout: A value was not received in time; the text names it.
        CommandDenied: The vehicle refused to send a value.
        RemoteCancelled: The connection was closed.
    """
    unknown = [name for name in names if not hasattr(vehicle, f"stream_{name}")]
    if unknown:
        raise InvalidArgumentError(f"there is no telemetry {unknown[0]!r} to wait for")
    streams = {name: getattr(vehicle, f"stream_{name}")() for name in names or _FIRST_VALUES}
    await wait_for_values(vehicle.telemetry, streams, timeout)


def stream_position(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.Position]:
    """Stream the global position, in degrees and metres (GLOBAL_POSITION_INT).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.GlobalPositionInt, common.HighLatency2)
    return _stream_value(vehicle, readers.read_position, messages, rate)


def stream_local_position(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.LocalPosition]:
    """Stream the position in the local frame, in metres (LOCAL_POSITION_NED or ODOMETRY).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.LocalPositionNed, common.Odometry)
    return _stream_value(vehicle, readers.read_local_position, messages, rate)


def stream_velocity(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.Velocity]:
    """Stream the velocity over ground, in m/s (LOCAL_POSITION_NED or GLOBAL_POSITION_INT).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.LocalPositionNed, common.GlobalPositionInt)
    return _stream_value(vehicle, readers.read_velocity, messages, rate)


def stream_attitude(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.Attitude]:
    """Stream the attitude, in degrees and degrees per second (ATTITUDE or ATTITUDE_QUATERNION).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.Attitude, common.AttitudeQuaternion)
    return _stream_value(vehicle, readers.read_attitude, messages, rate)


def stream_vfr_hud(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.VfrHud]:
    """Stream airspeed, ground speed and climb rate in m/s, and throttle in percent (VFR_HUD).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.VfrHud, common.HighLatency2)
    return _stream_value(vehicle, readers.read_vfr_hud, messages, rate)


def stream_home(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.HomePosition]:
    """Stream the home position, in degrees and metres above mean sea level (HOME_POSITION).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.HomePosition,)
    return _stream_value(vehicle, readers.read_home, messages, _HOME_RATE if rate is None else rate)


def stream_wind(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.Wind]:
    """Stream the estimated wind, in m/s (WIND_COV or WIND).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.WindCov, ardupilotmega.Wind, common.HighLatency2)
    return _stream_value(vehicle, readers.read_wind, messages, rate)


def stream_odometry(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.Odometry]:
    """Stream the odometry estimate, in metres, m/s and degrees per second (ODOMETRY).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.Odometry,)
    return _stream_value(vehicle, readers.read_odometry, messages, rate)


def stream_gps(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.Gps]:
    """Stream the satellite navigation state, in degrees, metres and m/s (GPS_RAW_INT).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.GpsRawInt,)
    return _stream_value(vehicle, readers.read_gps, messages, rate)


def stream_imu(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.Imu]:
    """Stream the inertial sensors, in m/s², degrees per second and gauss (HIGHRES_IMU or SCALED_IMU).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.HighresImu, common.ScaledImu, common.RawImu)
    return _stream_value(vehicle, readers.read_imu, messages, rate)


def stream_rc(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.Rc]:
    """Stream the radio control input, in microseconds per channel (RC_CHANNELS or RC_CHANNELS_RAW).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.RcChannels, common.RcChannelsRaw)
    return _stream_value(vehicle, readers.read_rc, messages, rate)


def stream_battery(vehicle: Vehicle, rate: float | None = None) -> ValueStream[values.Battery]:
    """Stream the first battery, in volts, amperes and percent (BATTERY_STATUS or SYS_STATUS).

    Args:
        rate: Hertz; None: as the vehicle sends it, or a default rate.

    Returns:
        The stream.
    """
    messages = (common.BatteryStatus, common.SysStatus)
    return _stream_value(vehicle, _first_battery, messages, rate)


def stream_armed(vehicle: Vehicle) -> ValueStream[bool]:
    """Stream whether the motors may run; the present state first (HEARTBEAT).

    Returns:
        The stream.
    """
    messages = (common.Heartbeat,)
    return _stream_value(vehicle, readers.read_armed, messages, None, changes=True)


def stream_mode(vehicle: Vehicle) -> ValueStream[str]:
    """Stream the name of the flight mode; the present one first (HEARTBEAT or CURRENT_MODE).

    Returns:
        The stream.
    """
    messages = (common.Heartbeat, common.CurrentMode)
    return _stream_value(vehicle, readers.read_mode, messages, None, changes=True)


def stream_in_air(vehicle: Vehicle) -> ValueStream[bool]:
    """Stream whether the vehicle flies; the present state first (EXTENDED_SYS_STATE or HEARTBEAT).

    Returns:
        The stream.
    """
    messages = (common.ExtendedSysState, common.Heartbeat)
    return _stream_value(vehicle, readers.read_in_air, messages, None, changes=True)


def stream_landed_state(vehicle: Vehicle) -> ValueStream[common.MavLandedState | int]:
    """Stream the changes of the MAV_LANDED_STATE; the present state first (EXTENDED_SYS_STATE).

    Returns:
        The stream.
    """
    messages = (common.ExtendedSysState,)
    return _stream_value(vehicle, readers.read_landed_state, messages, None, changes=True)


def _stream_value(
    vehicle: Vehicle,
    read: Callable[[Telemetry], Any],
    messages: tuple[type[Message], ...],
    rate: float | None,
    *,
    changes: bool = False,
) -> ValueStream[Any]:
    return ValueStream(vehicle.telemetry, read, messages, rate, changes=changes)


def _first_battery(telemetry: Telemetry) -> values.Battery | None:
    return next(iter(readers.read_batteries(telemetry).values()), None)
