"""ArduPilot: modes rather than commands, altitudes above home, and a set of modes for each vehicle type."""

from __future__ import annotations

from contextlib import suppress
from math import cos, degrees, radians, sin
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import (
    CommandDenied,
    ParameterDenied,
    ParameterTimeout,
    RemoteDenied,
    RemoteError,
    RemoteTimeout,
)
from mavstack.geodesy import offset_location
from mavstack.services.parameters import RENAMED
from mavstack.services.setpoints import AttitudeSetpoint
from mavstack.vehicle.firmware import ardupilot_modes
from mavstack.vehicle.firmware.firmware import (
    CHANGE_MODE,
    CMD,
    FRAME,
    GROUNDED,
    REQUEST_TIMEOUT,
    Firmware,
    OrbitEntry,
)
from mavstack.vehicle.firmware.target_setpoint import send_target
from mavstack.vehicle.geography import Location
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Message
    from mavstack.dialects.enums import MavEnum
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.services.setpoints import Setpoint

_GUIDED: Final = frozenset({"guided"})
_WINGED: Final = frozenset({VehicleType.PLANE, VehicleType.VTOL})
#: The first version of ArduPlane whose DO_REPOSITION has a radius.
_REPOSITION_RADIUS: Final = (4, 3)
_ATTITUDE_ONLY: Final = (
    "ArduPlane follows attitudes only: use goto(), or begin with guided(first=AttitudeSetpoint(...))"
)
#: Modes in which arming needs no position.
_NO_POSITION_MODES: Final = frozenset(
    {"stabilize", "acro", "alt_hold", "sport", "flip", "autotune", "manual", "hold", "steering", "flowhold"}
    | {"systemid", "turtle", "guided_nogps", "surface", "motordetect"}
)
#: Bit of AUTO_OPTIONS: arming is allowed in AUTO.
_ARMING_IN_AUTO: Final = 1
#: Bit of Q_OPTIONS: arming is allowed only in quadplane modes, and in the modes that do not check this
#: option.
_ARMING_IN_Q_MODES_ONLY: Final = 1 << 18
_WITHOUT_Q_CHECK: Final = frozenset({"auto", "guided", "loiter_alt_qland"})
#: Bit of CIRCLE_OPTIONS: the centre of the circle is the position where the mode is entered.
_CENTER_AT_ENTRY: Final = 4
_NO_LANDING: Final = (
    "its mission has no landing sequence and it has no AUTOLAND mode: "
    "upload a mission with DO_LAND_START and NAV_LAND, or let it circle home by rtl()"
)
#: The parameter that holds the takeoff altitude of a plane.
_TAKEOFF_ALTITUDE: Final = "TKOFF_ALT"
#: A plane on its takeoff run reports that it flies; below this height above home, in metres, it may still
#: take off.
_MIN_FLYING_HEIGHT: Final = 2.0
_CLIMB_REMEDY: Final = "go to another altitude by goto() or move()"
_RADIUS: Final = RENAMED["CIRCLE_RADIUS"]
_NO_SUCH_PARAMETER: Final = common.MavParamError.DOES_NOT_EXIST
#: The throttle channel if RCMAP_THROTTLE is not known.
_DEFAULT_THROTTLE_CHANNEL: Final = 3
#: The middle and the dead zone of the throttle channel in microseconds.
_THROTTLE_MIDDLE: Final = 1500
_THROTTLE_DEAD_ZONE: Final = 100


class ArduPilot(Firmware):
    """A vehicle that runs ArduPilot."""

    NAME: ClassVar[str] = "ArduPilot"
    MODES: ClassVar[Mapping[str, frozenset[str]]] = MappingProxyType(
        {
            "takeoff": _GUIDED | {"takeoff"},
            # A plane lands in AUTO, by a landing sequence in its mission.
            "land": frozenset({"land", "qland", "auto", "auto_rtl", "autoland"}),
            "rtl": frozenset({"rtl", "qrtl", "smart_rtl", "auto_rtl", "auto"}),
            "goto": _GUIDED,
            "orbit": _GUIDED | {"circle"},
            "turn": _GUIDED,
            "guided": _GUIDED,
            "mission": frozenset({"auto", "auto_rtl", "rtl", "qrtl"}),
        }
    )
    LACKING_TYPES: ClassVar[Mapping[str, frozenset[VehicleType]]] = MappingProxyType(
        dict.fromkeys(("takeoff", "land", "orbit"), GROUNDED) | {"rtl": frozenset({VehicleType.SUB})}
    )
    NO_ARMING_MODES: ClassVar[Mapping[VehicleType, frozenset[str]]] = ardupilot_modes.NO_ARMING
    SELF_STARTING_MODES: ClassVar[Mapping[VehicleType, frozenset[str]]] = ardupilot_modes.SELF_STARTING
    WAITING_MODES: ClassVar[Mapping[VehicleType, str]] = ardupilot_modes.WAITING
    HOLD_MODES: ClassVar[Mapping[VehicleType, str]] = ardupilot_modes.HOLD
    LAND_MODES: ClassVar[Mapping[VehicleType, str]] = ardupilot_modes.LAND
    FEATURES: ClassVar[Mapping[str, bool]] = MappingProxyType(
        dict.fromkeys(
            ("parameters", "mission", "logs", "servos", "relays", "motor_test", "manual_control"), True
        )
        | {"flashing": True, "actuators": False, "shell": False, "events": False, "failures": False}
    )
    EQUIPMENT_PARAMETERS: ClassVar[Mapping[str, tuple[str, ...]]] = MappingProxyType(
        {"gripper": ("GRIP_ENABLE",), "winch": ("WINCH_TYPE",), "osd": ("OSD_TYPE",)}
    )
    COMMANDS: ClassVar[type[MavEnum]] = ardupilotmega.MavCmd
    ESTIMATOR_MESSAGE: ClassVar[type[Message]] = ardupilotmega.EkfStatusReport
    #: A boat that holds its position drifts within LOIT_RADIUS before it uses its motors again.
    STOPPING_RADII: ClassVar[Mapping[VehicleType, Mapping[str, float]]] = MappingProxyType(
        {VehicleType.ROVER: {"WP_RADIUS": 2.0}, VehicleType.BOAT: {"WP_RADIUS": 2.0, "LOIT_RADIUS": 2.0}}
    )
    #: All failed checks are sent in one run, on request and every half minute.
    PREARM_RUN: ClassVar[float] = 3.0
    PREARM_LIFETIME: ClassVar[float] = 40.0
    RAW_IMU_IS_SCALED: ClassVar[bool] = True
    HEARTBEAT_SHOWS_IN_AIR: ClassVar[bool] = True
    MOTOR_TEST_ARMS: ClassVar[bool] = True

    @staticmethod
    def high_latency_armed(summary: common.HighLatency2) -> bool | None:
        """Return the armed state: `custom0` is the base mode of HEARTBEAT."""
        return bool(summary.custom0 & common.MavModeFlag.SAFETY_ARMED)

    @staticmethod
    def in_air(info: ComponentInfo) -> bool | None:
        """Return whether the vehicle flies: armed on the ground it stands by, in the air it is active."""
        if not info.armed or info.system_status == common.MavState.STANDBY:
            return False
        return True if info.system_status == common.MavState.ACTIVE else None

    @property
    def _type(self) -> VehicleType:
        return self.vehicle.vehicle_type

    async def takeoff(self, altitude: float) -> None:
        if not self._type.flies:
            raise self.unsupported("take off")
        if self._type is VehicleType.PLANE:
            await self.changes.set_parameter(_TAKEOFF_ALTITUDE, altitude, starting=True)
            await self.changes.set_mode("TAKEOFF")
            return
        await self.changes.set_mode("GUIDED")
        await self.command(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, altitude)

    async def reason_against_takeoff(self, altitude: float) -> str | None:
        """Return that it flies; a plane in TAKEOFF keeps the altitude that it read as it began to move."""
        if self._type is VehicleType.PLANE and (self.vehicle.mode or "").upper() == "TAKEOFF":
            present = await self.read_number(_TAKEOFF_ALTITUDE)
            if present == altitude:
                return None
            height = "another altitude" if present is None else f"{present:g} m"
            return f"it takes off to {height} already; {_CLIMB_REMEDY}"
        if not self.vehicle.in_air:
            return None
        with suppress(RemoteError):
            if await self.vehicle.get_relative_altitude() < _MIN_FLYING_HEIGHT:
                return None
        return f"it is in the air; {_CLIMB_REMEDY}"

    async def land(self) -> None:
        """Land here; a plane lands where its mission says, as it has no other way."""
        if self._type is VehicleType.PLANE:
            await self._land_plane()
        elif self._type in self.LAND_MODES:
            await self.changes.set_mode(self.LAND_MODES[self._type])
        else:
            raise self.unsupported("land")

    async def _land_plane(self) -> None:
        """Start the landing sequence of the mission; without one, land in AUTOLAND, which Plane 4.7 has."""
        try:
            await self.command(CMD.DO_LAND_START)
        except CommandDenied as refusal:
            try:
                await self.changes.set_mode("AUTOLAND")
            except (RemoteDenied, RemoteTimeout):
                refusal.status_texts = (*refusal.status_texts, _NO_LANDING)
                raise refusal from None

    async def rtl(self) -> None:
        if self._type is VehicleType.SUB:
            raise self.unsupported("return by itself")
        await self.changes.set_mode("RTL")

    async def hold(self) -> None:
        await self.changes.set_mode(self.HOLD_MODES.get(self._type, "LOITER"))

    async def guide(self) -> None:
        await self.changes.set_mode("GUIDED")

    async def goto(self, location: Location, *, yaw: float | None, radius: float | None) -> None:
        """Go by DO_REPOSITION, or by a setpoint where an older version does not support the command."""
        await self.changes.set_mode("GUIDED")
        altitude = await self._altitude_of(location)
        # For a vehicle on a wing this param is the direction of the circle.
        heading = 0.0 if yaw is None or self._type in _WINGED else self.yaw_of(yaw)
        try:
            await self.command(
                CMD.DO_REPOSITION, -1, CHANGE_MODE, radius or 0.0, heading,
                location.latitude, location.longitude, altitude, frame=FRAME.GLOBAL_RELATIVE_ALT,
            )  # fmt: skip
        except CommandDenied as error:
            if error.code != common.MavResult.UNSUPPORTED or self._type in _WINGED:
                raise
            await send_target(self.vehicle, Location(location.latitude, location.longitude, altitude))
        if yaw is not None and self._type is VehicleType.COPTER:
            await self.turn(yaw)

    @property
    def can_orbit(self) -> bool:
        """True if vehicles of this type circle locations with this firmware."""
        return self._type is VehicleType.COPTER or self._type in _WINGED

    def check_setpoint(self, setpoint: Setpoint) -> None:
        """Raise unless ArduPlane follows a setpoint: of positions it takes the altitude only."""
        if self._type in _WINGED and not isinstance(setpoint, AttitudeSetpoint):
            raise self.unsupported("follow setpoints of positions and velocities", _ATTITUDE_ONLY)

    async def check_circle(self, radius: float, *, orbit: bool) -> None:
        """Raise if ArduPlane ignores the radius of DO_REPOSITION, as before 4.3, or hovers there."""
        if self._type is VehicleType.VTOL and await self.read_number("Q_GUIDED_MODE"):
            reason = "it hovers at its destination in GUIDED; set Q_GUIDED_MODE to 0"
            raise self.unsupported("circle a location", reason)
        version = await self.read_flight_version() if self._type in _WINGED else None
        if version is None or version[:2] >= _REPOSITION_RADIUS:
            return
        plane = f"ArduPlane {version.major}.{version.minor}"
        await self._check_parameter_circle(radius, "WP_LOITER_RAD", plane)
        if orbit and radius > 0 and (await self.read_number("WP_LOITER_RAD") or 0.0) < 0:
            reason = f"{plane} circles counter-clockwise while WP_LOITER_RAD is negative; set that parameter"
            raise self.unsupported("orbit clockwise", reason)

    async def prepare_orbit(self, center: Location, radius: float) -> OrbitEntry | None:
        """Return the centre for a copter, which circles the position where it enters CIRCLE.

        Without CIRCLE_OPTIONS, which 4.1 introduced, the centre lies ahead of it by the radius.
        """
        if self._type in _WINGED:
            return None
        if not self.can_orbit:
            raise self.unsupported("orbit")
        await self._check_throttle()
        if await self._circle_around_entry():
            return OrbitEntry(center)
        heading = self.vehicle.heading or 0.0
        behind = -abs(radius)
        north, east = behind * cos(radians(heading)), behind * sin(radians(heading))
        start = offset_location(center.latitude, center.longitude, north, east)
        return OrbitEntry(Location(*start, center.altitude), heading)

    async def _circle_around_entry(self) -> bool:
        """Make the position of entry the centre of the circle; return False if the version cannot do that."""
        params = self.vehicle.params
        try:
            options = int((await params.get("CIRCLE_OPTIONS")).value)
            await self.changes.set_parameter("CIRCLE_OPTIONS", options | _CENTER_AT_ENTRY)
        except (ParameterDenied, ParameterTimeout):
            return False
        return True

    async def orbit(self, center: Location, *, radius: float, speed: float | None) -> None:
        """Send a wing to the location, which it circles; let a copter circle its position in CIRCLE."""
        if self._type is VehicleType.COPTER:
            await self._set_circle_parameters(radius, speed)
            await self.changes.set_mode("CIRCLE")
        else:
            await self._loiter(center, radius)

    async def turn(self, heading: float) -> None:
        """Turn in GUIDED: in other modes the command is accepted without any effect."""
        if self._type is VehicleType.PLANE:
            raise self.unsupported("turn on the spot")
        if (self.vehicle.mode or "").lower() not in _GUIDED:
            await self.guide()
        await self.command(CMD.CONDITION_YAW, heading % 360.0, 0, 0, 0)

    def needs_position(self, mode: str | None) -> bool:
        """Return True for copters, rovers and boats, except in modes that are flown without a position.

        A submarine often has no position at all: for it the mode has to be named.
        """
        if self._type is VehicleType.SUB:
            return mode is not None and mode.lower() not in _NO_POSITION_MODES
        navigates = self._type in (VehicleType.COPTER, VehicleType.ROVER, VehicleType.BOAT)
        return navigates and (mode or "guided").lower() not in _NO_POSITION_MODES

    def allows_arming(self, mode: str | None) -> bool:
        """Return whether it arms in a mode; a copter's AUTO_OPTIONS and a quadplane's Q_OPTIONS count too."""
        name = (mode or "").lower()
        if self._type is VehicleType.COPTER and name == "auto":
            return bool(self._options("AUTO_OPTIONS") & _ARMING_IN_AUTO)
        if self._type is VehicleType.VTOL and self._options("Q_OPTIONS") & _ARMING_IN_Q_MODES_ONLY:
            return (name.startswith("q") and super().allows_arming(mode)) or name in _WITHOUT_Q_CHECK
        return super().allows_arming(mode)

    def _options(self, name: str) -> int:
        """Return the bits of a parameter, as far as it is known."""
        found = self.vehicle.params.cached.get(name)
        return 0 if found is None else int(found.value)

    async def start_mission(self) -> None:
        """Enter AUTO, and send MISSION_START: on the ground a copter would wait for the throttle stick."""
        await self.changes.set_mode("AUTO")
        if self._type is not VehicleType.PLANE:
            await self.command(CMD.MISSION_START)

    async def look_at(self, location: Location) -> None:
        await self.command(
            CMD.DO_SET_ROI_LOCATION, 0, 0, 0, 0, location.latitude, location.longitude,
            location.altitude or 0.0, frame=FRAME.GLOBAL_RELATIVE_ALT,
        )  # fmt: skip

    async def look_ahead(self) -> None:
        """Clear the location; versions before 4.2 lack the command and take a location of zeros for it."""
        try:
            await super().look_ahead()
        except CommandDenied as error:
            if error.code != common.MavResult.UNSUPPORTED:
                raise
            await self.command(CMD.DO_SET_ROI_LOCATION, 0, 0, 0, 0, 0, 0, 0, frame=FRAME.GLOBAL_RELATIVE_ALT)

    async def look_at_next_waypoint(self, pitch: float, roll: float, yaw: float) -> None:
        raise self.unsupported("look at its next waypoint", "ArduPilot has no command for that")

    async def set_actuator(self, number: int, value: float) -> None:
        raise self.unsupported("set an actuator", "ArduPilot numbers its outputs as servos; use set_servo")

    async def set_ekf_source(self, number: int) -> None:
        await self.command(ardupilotmega.MavCmd.SET_EKF_SOURCE_SET, number)

    async def _altitude_of(self, location: Location) -> float:
        # ArduRover 4.1 reports an altitude above the sea as an altitude above home
        if not self._type.has_altitude:
            return 0.0
        altitude = location.altitude
        return await self.vehicle.get_relative_altitude() if altitude is None else altitude

    async def _check_throttle(self) -> None:
        """Raise if the throttle stick is off its middle: in CIRCLE a copter climbs and sinks by it."""
        # an older ArduPilot, or one without a receiver, does not send RC_CHANNELS
        with suppress(RemoteError):
            await self.vehicle.component.request_message(common.RcChannels, timeout=REQUEST_TIMEOUT)
        channel = self.vehicle.params.cached.get("RCMAP_THROTTLE")
        pulse = self.vehicle.rc_pulse(_DEFAULT_THROTTLE_CHANNEL if channel is None else int(channel.value))
        if pulse is not None and abs(pulse - _THROTTLE_MIDDLE) > _THROTTLE_DEAD_ZONE:
            reason = f"its throttle stick is at {pulse} us and would change the altitude; center the stick"
            raise self.unsupported("orbit now", reason)

    async def _loiter(self, center: Location, radius: float) -> None:
        altitude = await self._altitude_of(center)
        direction = 1.0 if radius < 0 else 0.0
        await self.changes.set_mode("GUIDED")
        await self.command(
            CMD.DO_REPOSITION, -1, CHANGE_MODE, abs(radius), direction,
            center.latitude, center.longitude, altitude, frame=FRAME.GLOBAL_RELATIVE_ALT,
        )  # fmt: skip

    async def _set_circle_parameters(self, radius: float, speed: float | None) -> None:
        params = self.vehicle.params
        clockwise = 1.0 if radius > 0 else -1.0
        await self._set_circle_radius(abs(radius))
        if speed is None:  # keep the angular rate that is set, in the requested direction
            rate = abs(float((await params.get("CIRCLE_RATE")).value))
        else:
            rate = degrees(speed / abs(radius))
        await self.changes.set_parameter("CIRCLE_RATE", clockwise * rate)

    async def _set_circle_radius(self, metres: float) -> None:
        """Set the radius by the name and in the unit of the version.

        The earlier name goes first: 4.7 refuses it at once, older versions leave the new one unanswered.
        """
        params = self.vehicle.params
        try:
            if _RADIUS.name not in params.cached:
                await self.changes.set_parameter(_RADIUS.earlier, metres / _RADIUS.factor)
                return
        except (ParameterDenied, ParameterTimeout) as error:
            if isinstance(error, ParameterDenied) and error.code != _NO_SUCH_PARAMETER:
                raise
        await self.changes.set_parameter(_RADIUS.name, metres)
