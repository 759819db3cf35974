"""Streams of the values that a vehicle reports, one method for each, and the wait for first values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import InvalidArgumentError
from mavstack.services import DEFAULT_WAIT_TIMEOUT
from mavstack.vehicle.telemetry import readers
from mavstack.vehicle.telemetry.properties import TelemetryProperties
from mavstack.vehicle.telemetry.value_stream import ValueStream, wait_for_values

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from mavstack.dialects import Message
    from mavstack.vehicle.telemetry import values
    from mavstack.vehicle.telemetry.telemetry import Telemetry

#: HOME_POSITION changes rarely, in hertz.
_HOME_RATE: Final = 0.5
#: The values that most programs need before a flight.
_FIRST_VALUES: Final = ("position", "battery", "gps", "home")


class TelemetryStreams(TelemetryProperties):
    """The streams of the values that a vehicle reports.

    `rate` is the rate to request while the stream is open, in hertz; None requests a default rate, and only
    for messages that the vehicle does not send by itself. Reading a stream raises `CommandDenied` if the
    vehicle refuses to send the value.
    """

    async def wait_for_telemetry(self, *names: str, timeout: float | None = DEFAULT_WAIT_TIMEOUT) -> None:
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
        unknown = [name for name in names if not hasattr(self, f"stream_{name}")]
        if unknown:
            raise InvalidArgumentError(f"there is no telemetry {unknown[0]!r} to wait for")
        streams = {name: getattr(self, f"stream_{name}")() for name in names or _FIRST_VALUES}
        await wait_for_values(self.telemetry, streams, timeout)

    def stream_position(self, rate: float | None = None) -> ValueStream[values.Position]:
        """Stream the global position, in degrees and metres (GLOBAL_POSITION_INT).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.GlobalPositionInt, common.HighLatency2)
        return self._stream_value(readers.read_position, messages, rate)

    def stream_local_position(self, rate: float | None = None) -> ValueStream[values.LocalPosition]:
        """Stream the position in the local frame, in metres (LOCAL_POSITION_NED or ODOMETRY).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.LocalPositionNed, common.Odometry)
        return self._stream_value(readers.read_local_position, messages, rate)

    def stream_velocity(self, rate: float | None = None) -> ValueStream[values.Velocity]:
        """Stream the velocity over ground, in m/s (LOCAL_POSITION_NED or GLOBAL_POSITION_INT).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.LocalPositionNed, common.GlobalPositionInt)
        return self._stream_value(readers.read_velocity, messages, rate)

    def stream_attitude(self, rate: float | None = None) -> ValueStream[values.Attitude]:
        """Stream the attitude, in degrees and degrees per second (ATTITUDE or ATTITUDE_QUATERNION).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.Attitude, common.AttitudeQuaternion)
        return self._stream_value(readers.read_attitude, messages, rate)

    def stream_vfr_hud(self, rate: float | None = None) -> ValueStream[values.VfrHud]:
        """Stream airspeed, ground speed and climb rate in m/s, and throttle in percent (VFR_HUD).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.VfrHud, common.HighLatency2)
        return self._stream_value(readers.read_vfr_hud, messages, rate)

    def stream_home(self, rate: float | None = None) -> ValueStream[values.HomePosition]:
        """Stream the home position, in degrees and metres above mean sea level (HOME_POSITION).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.HomePosition,)
        return self._stream_value(readers.read_home, messages, _HOME_RATE if rate is None else rate)

    def stream_wind(self, rate: float | None = None) -> ValueStream[values.Wind]:
        """Stream the estimated wind, in m/s (WIND_COV or WIND).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.WindCov, ardupilotmega.Wind, common.HighLatency2)
        return self._stream_value(readers.read_wind, messages, rate)

    def stream_odometry(self, rate: float | None = None) -> ValueStream[values.Odometry]:
        """Stream the odometry estimate, in metres, m/s and degrees per second (ODOMETRY).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.Odometry,)
        return self._stream_value(readers.read_odometry, messages, rate)

    def stream_gps(self, rate: float | None = None) -> ValueStream[values.Gps]:
        """Stream the satellite navigation state, in degrees, metres and m/s (GPS_RAW_INT).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.GpsRawInt,)
        return self._stream_value(readers.read_gps, messages, rate)

    def stream_imu(self, rate: float | None = None) -> ValueStream[values.Imu]:
        """Stream the inertial sensors, in m/s², degrees per second and gauss (HIGHRES_IMU or SCALED_IMU).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.HighresImu, common.ScaledImu, common.RawImu)
        return self._stream_value(readers.read_imu, messages, rate)

    def stream_rc(self, rate: float | None = None) -> ValueStream[values.Rc]:
        """Stream the radio control input, in microseconds per channel (RC_CHANNELS or RC_CHANNELS_RAW).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.RcChannels, common.RcChannelsRaw)
        return self._stream_value(readers.read_rc, messages, rate)

    def stream_battery(self, rate: float | None = None) -> ValueStream[values.Battery]:
        """Stream the first battery, in volts, amperes and percent (BATTERY_STATUS or SYS_STATUS).

        Args:
            rate: Hertz; None: as the vehicle sends it, or a default rate.

        Returns:
            The stream.
        """
        messages = (common.BatteryStatus, common.SysStatus)
        return self._stream_value(_first_battery, messages, rate)

    def stream_armed(self) -> ValueStream[bool]:
        """Stream whether the motors may run; the present state first (HEARTBEAT).

        Returns:
            The stream.
        """
        messages = (common.Heartbeat,)
        return self._stream_value(readers.read_armed, messages, None, changes=True)

    def stream_mode(self) -> ValueStream[str]:
        """Stream the name of the flight mode; the present one first (HEARTBEAT or CURRENT_MODE).

        Returns:
            The stream.
        """
        messages = (common.Heartbeat, common.CurrentMode)
        return self._stream_value(readers.read_mode, messages, None, changes=True)

    def stream_in_air(self) -> ValueStream[bool]:
        """Stream whether the vehicle flies; the present state first (EXTENDED_SYS_STATE or HEARTBEAT).

        Returns:
            The stream.
        """
        messages = (common.ExtendedSysState, common.Heartbeat)
        return self._stream_value(readers.read_in_air, messages, None, changes=True)

    def stream_landed_state(self) -> ValueStream[common.MavLandedState | int]:
        """Stream the changes of the MAV_LANDED_STATE; the present state first (EXTENDED_SYS_STATE).

        Returns:
            The stream.
        """
        messages = (common.ExtendedSysState,)
        return self._stream_value(readers.read_landed_state, messages, None, changes=True)

    def _stream_value(
        self,
        read: Callable[[Telemetry], Any],
        messages: tuple[type[Message], ...],
        rate: float | None,
        *,
        changes: bool = False,
    ) -> ValueStream[Any]:
        return ValueStream(self.telemetry, read, messages, rate, changes=changes)


def _first_battery(telemetry: Telemetry) -> values.Battery | None:
    return next(iter(readers.read_batteries(telemetry).values()), None)
