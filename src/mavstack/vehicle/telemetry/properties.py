"""The telemetry part of a vehicle: typed messages as they arrive, and values as properties.

A property returns the value that was received last, and None before the first one; it neither sends nor
waits. The messages that the vehicle sends are requested by streams, by `set_message_rate`, and by the actions
that need them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import Message
from mavstack.services import DEFAULT_WAIT_TIMEOUT
from mavstack.vehicle.telemetry import readers

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.dialects import common
    from mavstack.node.dispatch import Listener
    from mavstack.vehicle.telemetry import values
    from mavstack.vehicle.telemetry.stream import MessageStream
    from mavstack.vehicle.telemetry.telemetry import Telemetry

AnyMessage = TypeVar("AnyMessage", bound=Message)


class TelemetryProperties:
    """The messages and values that a vehicle reports, read from `telemetry`."""

    telemetry: Telemetry

    # Messages

    def latest(self, message: type[AnyMessage], component: int | None = None) -> AnyMessage | None:
        """Return the last message of a class.

        Args:
            message: The message class, such as `common.Attitude`.
            component: The component id of the sender; None is the autopilot.

        Returns:
            The message, or None if none was received.
        """
        return self.telemetry.latest(message, component)

    def age(self, message: type[Message], component: int | None = None) -> float | None:
        """Return the seconds since the last message of a class was received.

        Args:
            message: The message class.
            component: The component id of the sender; None is the autopilot.

        Returns:
            Seconds, or None if no message was received.
        """
        return self.telemetry.age(message, component)

    def stream(
        self, *messages: type[AnyMessage], rate: float | None = None, queue: int = 1000
    ) -> MessageStream[AnyMessage]:
        """Return an async iterator of the autopilot's messages of these classes, as they arrive.

        Args:
            *messages: The message classes; none of them: all messages.
            rate: The rate to request while the stream is open, in hertz; None requests a default rate, and
                only for messages that the vehicle does not send by itself.
            queue: The number of unread messages that are kept; a slow reader loses the oldest.

        Returns:
            The stream; reading it raises `CommandDenied` if the vehicle refuses the rate and sends nothing.

        Raises:
            InvalidArgumentError: A rate without message classes.
        """
        return self.telemetry.stream(*messages, rate=rate, queue=queue)

    async def wait_for_message(
        self, message: type[AnyMessage], *, timeout: float | None = DEFAULT_WAIT_TIMEOUT
    ) -> AnyMessage:
        """Return the next message of a class, which is requested if the vehicle does not send it by itself.

        Args:
            message: The message class.
            timeout: Seconds to wait; None waits for ever.

        Returns:
            The message.

        Raises:
            MessageTimeout: No message arrived in time.
            CommandDenied: The vehicle refused to send the message, and none arrived.
            RemoteCancelled: The connection was closed.
        """
        return await self.telemetry.wait_for_message(message, timeout=timeout)

    def add_listener(
        self,
        message: type[AnyMessage] | tuple[type[AnyMessage], ...],
        callback: Callable[[AnyMessage], object],
        *,
        component: int | None = None,
    ) -> Listener:
        """Call a function with each message of a class as soon as it is received.

        Args:
            message: The message class, or a tuple of classes.
            callback: A plain function, which must return quickly. An exception that it raises goes to the
                event loop's exception handler.
            component: The component id of the sender; None is the autopilot.

        Returns:
            The registration; its `close()` unregisters the function.
        """
        return self.telemetry.add_listener(message, callback, component=component)

    async def set_message_rate(
        self, message: type[Message], rate: float | None, *, timeout: float | None = None
    ) -> None:
        """Request a message from the autopilot at a rate, permanently.

        The rate is requested again after a reboot (SET_MESSAGE_INTERVAL).

        Args:
            message: The message class.
            rate: Hertz; None returns to the rate at which the vehicle sends the message by itself.
            timeout: Seconds for the whole call; None sets no overall limit.

        Raises:
            CommandDenied: The vehicle refused the rate.
            CommandTimeout: The vehicle did not answer in time.
        """
        await self.telemetry.set_message_rate(message, rate, timeout=timeout)

    # Position and motion

    @property
    def position(self) -> values.Position | None:
        """The global position, in degrees and metres (GLOBAL_POSITION_INT)."""
        return readers.read_position(self.telemetry)

    @property
    def local_position(self) -> values.LocalPosition | None:
        """The position in the local frame, in metres (LOCAL_POSITION_NED)."""
        return readers.read_local_position(self.telemetry)

    @property
    def velocity(self) -> values.Velocity | None:
        """The velocity over ground, in m/s (LOCAL_POSITION_NED or GLOBAL_POSITION_INT)."""
        return readers.read_velocity(self.telemetry)

    @property
    def attitude(self) -> values.Attitude | None:
        """The attitude, in degrees and degrees per second (ATTITUDE or ATTITUDE_QUATERNION)."""
        return readers.read_attitude(self.telemetry)

    @property
    def vfr_hud(self) -> values.VfrHud | None:
        """Airspeed, ground speed and climb rate in m/s, and throttle in percent (VFR_HUD)."""
        return readers.read_vfr_hud(self.telemetry)

    @property
    def home(self) -> values.HomePosition | None:
        """The home position, in degrees and metres above mean sea level (HOME_POSITION)."""
        return readers.read_home(self.telemetry)

    @property
    def wind(self) -> values.Wind | None:
        """The estimated wind, in m/s (WIND_COV or WIND)."""
        return readers.read_wind(self.telemetry)

    @property
    def odometry(self) -> values.Odometry | None:
        """The odometry estimate, in metres, m/s and degrees per second (ODOMETRY)."""
        return readers.read_odometry(self.telemetry)

    # Sensors and power

    @property
    def gps(self) -> values.Gps | None:
        """The state of the satellite navigation receiver, in degrees, metres and m/s (GPS_RAW_INT)."""
        return readers.read_gps(self.telemetry)

    @property
    def imu(self) -> values.Imu | None:
        """The inertial sensors, in m/s², degrees per second and gauss (HIGHRES_IMU or SCALED_IMU)."""
        return readers.read_imu(self.telemetry)

    @property
    def rc(self) -> values.Rc | None:
        """The radio control input, in microseconds per channel (RC_CHANNELS or RC_CHANNELS_RAW)."""
        return readers.read_rc(self.telemetry)

    @property
    def battery(self) -> values.Battery | None:
        """The first battery, in volts, amperes and percent (BATTERY_STATUS or SYS_STATUS)."""
        return next(iter(readers.read_batteries(self.telemetry).values()), None)

    @property
    def batteries(self) -> Mapping[int, values.Battery]:
        """All batteries by id, in volts, amperes and percent (BATTERY_STATUS or SYS_STATUS)."""
        return readers.read_batteries(self.telemetry)

    # State

    @property
    def armed(self) -> bool | None:
        """True if the motors may run (HEARTBEAT)."""
        return readers.read_armed(self.telemetry)

    @property
    def mode(self) -> str | None:
        """The name of the flight mode (HEARTBEAT or CURRENT_MODE)."""
        return readers.read_mode(self.telemetry)

    @property
    def in_air(self) -> bool | None:
        """True if the vehicle flies (EXTENDED_SYS_STATE, HEARTBEAT, or its height with speed or throttle)."""
        return readers.read_in_air(self.telemetry)

    @property
    def landed_state(self) -> common.MavLandedState | int | None:
        """The MAV_LANDED_STATE: on the ground, taking off, in the air or landing (EXTENDED_SYS_STATE)."""
        return readers.read_landed_state(self.telemetry)

    @property
    def vtol_state(self) -> common.MavVtolState | int | None:
        """The MAV_VTOL_STATE: hovering or flying forward; None if it is no VTOL (EXTENDED_SYS_STATE)."""
        return readers.read_vtol_state(self.telemetry)

    @property
    def system_status(self) -> common.MavState | int | None:
        """The MAV_STATE of the autopilot (HEARTBEAT)."""
        return readers.read_system_status(self.telemetry)

    @property
    def mav_type(self) -> common.MavType | int | None:
        """The MAV_TYPE of the vehicle (HEARTBEAT)."""
        info = self.telemetry.component.info
        return None if info is None else info.type

    @property
    def status_texts(self) -> list[values.StatusText]:
        """The last status texts of the vehicle's system, oldest first (STATUSTEXT)."""
        return self.telemetry.status_texts.all()
