"""The face of a vehicle's telemetry: typed messages as they come, and values as properties.

A property tells what was heard last and is None before; it neither sends nor waits. What a vehicle is to send
is asked for by streams, by `set_message_rate`, and by whatever needs it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import Message
from mavstack.vehicle.telemetry import readers

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.dialects import common
    from mavstack.node.dispatch import Listening
    from mavstack.vehicle.telemetry import values
    from mavstack.vehicle.telemetry.stream import Stream
    from mavstack.vehicle.telemetry.telemetry import Telemetry

AnyMessage = TypeVar("AnyMessage", bound=Message)


class TelemetryProperties:
    """What a vehicle tells; `telemetry` is what was heard of it."""

    telemetry: Telemetry

    # Messages

    def latest(self, kind: type[AnyMessage], component: int | None = None) -> AnyMessage | None:
        """The last message of a kind, of the autopilot unless a component is named; None if none came."""
        return self.telemetry.latest(kind, component)

    def age(self, kind: type[Message], component: int | None = None) -> float | None:
        """How long ago the last message of a kind came, in seconds; None if none came."""
        return self.telemetry.age(kind, component)

    def stream(
        self, *kinds: type[AnyMessage], rate: float | None = None, queue: int = 1000
    ) -> Stream[AnyMessage]:
        """Iterate over the autopilot's messages of these kinds, as they come.

        With a `rate` it is asked for so many a second, without one only for what does not come by itself.
        Raises `CommandDenied` if it refuses, and nothing comes. A slow reader loses the oldest.
        """
        return self.telemetry.stream(*kinds, rate=rate, queue=queue)

    async def wait_for_message(self, kind: type[AnyMessage], *, timeout: float = 10.0) -> AnyMessage:
        """The next message of a kind; raises `MessageTimeout`, or `CommandDenied` if the vehicle has none."""
        return await self.telemetry.wait_for_message(kind, timeout=timeout)

    def add_listener(
        self, kind: type[AnyMessage], callback: Callable[[AnyMessage], object], component: int | None = None
    ) -> Listening:
        """Call a plain function with each message of a kind, at once, until the result is closed."""
        return self.telemetry.add_listener(kind, callback, component)

    async def set_message_rate(self, kind: type[Message], rate: float | None) -> None:
        """Have the autopilot send a message so many times a second for good, or as by itself (None).

        It is asked again when it rebooted. Raises `CommandDenied` or `CommandTimeout`.
        """
        await self.telemetry.set_message_rate(kind, rate)

    # Where it is, and how it moves

    @property
    def position(self) -> values.Position | None:
        """Where it is on earth."""
        return readers.read_position(self.telemetry)

    @property
    def local_position(self) -> values.LocalPosition | None:
        """Where it is in its own frame."""
        return readers.read_local_position(self.telemetry)

    @property
    def velocity(self) -> values.Velocity | None:
        """How fast it moves, and where to."""
        return readers.read_velocity(self.telemetry)

    @property
    def attitude(self) -> values.Attitude | None:
        """How it is turned."""
        return readers.read_attitude(self.telemetry)

    @property
    def vfr_hud(self) -> values.VfrHud | None:
        """Air speed, ground speed, climb and throttle."""
        return readers.read_vfr_hud(self.telemetry)

    @property
    def home(self) -> values.HomePosition | None:
        """Where it returns to."""
        return readers.read_home(self.telemetry)

    @property
    def wind(self) -> values.Wind | None:
        """The wind that it estimates."""
        return readers.read_wind(self.telemetry)

    @property
    def odometry(self) -> values.Odometry | None:
        """Its own odometry."""
        return readers.read_odometry(self.telemetry)

    # Sensors and power

    @property
    def gps(self) -> values.Gps | None:
        """Its receiver of satellites."""
        return readers.read_gps(self.telemetry)

    @property
    def imu(self) -> values.Imu | None:
        """Its inertial unit."""
        return readers.read_imu(self.telemetry)

    @property
    def rc(self) -> values.Rc | None:
        """Its radio control."""
        return readers.read_rc(self.telemetry)

    @property
    def battery(self) -> values.Battery | None:
        """Its first battery."""
        return next(iter(readers.read_batteries(self.telemetry).values()), None)

    @property
    def batteries(self) -> Mapping[int, values.Battery]:
        """All its batteries, by their ids."""
        return readers.read_batteries(self.telemetry)

    # What it is doing

    @property
    def armed(self) -> bool | None:
        """Whether its motors may run."""
        return readers.read_armed(self.telemetry)

    @property
    def mode(self) -> str | None:
        """The name of the mode that it is in."""
        return readers.read_mode(self.telemetry)

    @property
    def in_air(self) -> bool | None:
        """Whether it flies."""
        return readers.read_in_air(self.telemetry)

    @property
    def landed_state(self) -> common.MavLandedState | int | None:
        """On the ground, taking off, in the air or landing."""
        return readers.read_landed_state(self.telemetry)

    @property
    def vtol_state(self) -> common.MavVtolState | int | None:
        """Whether it hovers or flies by its wings; None if it can do only one of them."""
        return readers.read_vtol_state(self.telemetry)

    @property
    def system_status(self) -> common.MavState | int | None:
        """The state of its autopilot."""
        return readers.read_system_status(self.telemetry)

    @property
    def mav_type(self) -> common.MavType | int | None:
        """What it is, as its heartbeat says."""
        info = self.telemetry.component.info
        return None if info is None else info.type

    @property
    def status_texts(self) -> list[values.StatusText]:
        """What it told people lately, the oldest first."""
        return self.telemetry.status_texts.all()
