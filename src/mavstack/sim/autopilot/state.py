"""The lowest interfaces of a simulated vehicle: its state, as the parts of its autopilot read it.

Parts of the autopilot (payload, rally points, long commands …) know no class above them: they take a
`VehicleState` or an `AutopilotState`. `interfaces.py` adds modes, the mission and the firmware profile.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, TypeVar

from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.dialects import Message
    from mavstack.node.engine import Engine
    from mavstack.services import Address, Event, Service
    from mavstack.services.command import CommandServer
    from mavstack.services.heartbeat import Discovery
    from mavstack.services.message_request import MessageServer
    from mavstack.services.mission import MissionServer, PlanStore
    from mavstack.services.modes import ModeServer
    from mavstack.services.serial_control import ShellServer
    from mavstack.services.terrain import TerrainMap
    from mavstack.sim.autopilot.flight_parameters import FlightParameters
    from mavstack.sim.autopilot.maneuvers import Maneuvers, Point
    from mavstack.sim.motion import Body
    from mavstack.sim.parameters import Parameters
    from mavstack.sim.port import Port
    from mavstack.sim.rangefinders import Rangefinder
    from mavstack.sim.vehicle_types import Firmware, Home, VehicleType

AnyEvent = TypeVar("AnyEvent", bound="Event")

#: Interval between two ticks of the autopilot, in seconds.
TICK = 0.1


class Watch(Protocol):
    """A check that runs on each tick, such as a failsafe or the fence."""

    def tick(self, now: float) -> None:
        """Check once at the time `now`, and act."""


class FaultControl(Protocol):
    """The injected faults of one vehicle."""

    active: dict[str, str]

    def inject(self, text: str) -> None:
        """Inject or end a fault, such as `gps off`."""

    def note(self, subject: str, text: str | None) -> None:
        """Record a fault of `subject`; None records its end."""


class ServiceAccess(Protocol):
    """The services of a vehicle that its autopilot uses directly."""

    discovery: Discovery
    shell: ShellServer

    def send(self, message: Message, target: Address | None = None) -> None:
        """Send a message at once; without a target to everybody."""

    def refresh_type(self) -> None:
        """Send the next HEARTBEAT with the present MAV_TYPE."""


class VehicleState(Protocol):
    """One simulated vehicle without its autopilot."""

    body: Body
    vehicle_type: VehicleType
    firmware: Firmware
    address: Address
    parameters: Parameters
    plans: PlanStore
    #: Simulated Unix time of the current step, and of the last boot.
    now: float
    booted_at: float
    boots: int
    #: The unique id of the board.
    serial: bytes
    ports: list[Port]
    #: The chosen rangefinders, and whether the vehicle has a proximity sensor.
    rangefinders: Sequence[Rangefinder]
    proximity: bool
    #: The terrain that the vehicle has from ground stations; None: it knows the flat ground.
    terrain: TerrainMap | None

    @property
    def uptime(self) -> float:
        """Seconds since the last boot."""

    @property
    def uptime_ms(self) -> int:
        """Milliseconds since the last boot, as in `time_boot_ms`."""

    @property
    def engine(self) -> Engine:
        """The engine that runs the services."""

    @property
    def commands(self) -> CommandServer:
        """The server of the command protocol."""

    @property
    def messages(self) -> MessageServer:
        """The server that streams telemetry."""

    @property
    def modes(self) -> ModeServer:
        """The server of the flight modes."""

    @property
    def mission(self) -> MissionServer:
        """The server of the mission protocol."""

    @property
    def faults(self) -> FaultControl:
        """The injected faults."""

    @property
    def services(self) -> ServiceAccess:
        """The services that parts of the autopilot use directly."""

    def on_event(self, kind: type[AnyEvent], reaction: Callable[[AnyEvent], None]) -> None:
        """Call `reaction` with each event of a class from the services."""

    def touch(self, service: Service) -> None:
        """Schedule a service whose method was called, so that its messages are sent."""

    def send_statustext(self, text: str, severity: int = common.MavSeverity.INFO) -> None:
        """Send a STATUSTEXT, and log it."""

    def armed_changed(self) -> None:
        """Publish that the vehicle was armed or disarmed."""

    def home_changed(self) -> None:
        """Publish the new home position."""

    def cut(self, off: bool) -> None:
        """Cut or restore all links."""

    def reboot(self) -> None:
        """Restart the autopilot."""


class AutopilotState(Protocol):
    """The state of one autopilot without its modes, mission and firmware profile."""

    body: Body
    flight_parameters: FlightParameters
    maneuvers: Maneuvers
    #: Simulated Unix time of the current tick, and of the last boot.
    now: float
    booted_at: float
    armed: bool
    armed_at: float
    disarmed_at: float
    disarm_reason: str
    landed: bool
    terminated: bool
    home: Home | None
    #: True if home was set by a command, so that arming does not move it.
    home_locked: bool
    #: The point that the vehicle flies to or circles, in local metres; for telemetry.
    target: Point | None
    watches: list[Watch]
    #: Names of the active failsafes; any of them makes the vehicle's state critical.
    failsafes: set[str]
    mode_reason: str

    @property
    def vehicle(self) -> VehicleState:
        """The vehicle of the autopilot."""

    @property
    def booted(self) -> bool:
        """True when start-up is complete."""

    @property
    def has_position(self) -> bool:
        """True while the position estimate is good."""

    @property
    def home_position(self) -> Point:
        """Home in local metres; the place of the start while there is no home."""

    @property
    def altitude(self) -> float:
        """Altitude above home, in metres."""

    @property
    def landed_state(self) -> int:
        """MAV_LANDED_STATE."""

    @property
    def system_status(self) -> int:
        """MAV_STATE."""

    @property
    def base_mode(self) -> int:
        """The flags of HEARTBEAT's `base_mode`."""

    def enter(self, number: int, reason: str, *, commanded: bool = False) -> bool:
        """Enter a mode by its `custom_mode`; returns False if it cannot be entered."""

    def restart_behaviour(self) -> None:
        """Restart the behaviour of the current mode."""

    def arm(self, *, force: bool = False) -> list[str]:
        """Arm; returns the reasons for a refusal, an empty list if the vehicle is armed now."""

    def disarm(self, reason: str) -> None:
        """Stop the motors, wherever the vehicle is."""

    def terminate(self) -> None:
        """Terminate the flight: stop the motors permanently."""

    def set_home_here(self) -> None:
        """Set home to the current position."""

    def set_home(self, latitude: float, longitude: float, altitude: float, *, yaw: float = 0.0) -> None:
        """Set home: degrees, metres above mean sea level, radians."""
