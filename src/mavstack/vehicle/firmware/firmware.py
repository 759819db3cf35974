"""The base class of firmwares, which keeps to standard commands, modes and messages.

A firmware class answers two questions. Its class attributes and static methods tell how the firmware reports
its state where messages leave that open; the telemetry readers use them. Its methods start an action; seeing
the action through is the same for all firmwares and stands in `mavstack.vehicle.actions`. `MODES` names the
modes in which an action goes on: the action was interrupted when the vehicle is in another mode.

The methods raise `CommandDenied`, `CommandTimeout` or `ModeTimeout` as the commands that they send do, and
`ActionUnsupported`, before anything is sent, where the vehicle type or the firmware lacks the action. Steps
that change a mode or a parameter go through `changes`, so that a call that fails later can reverse them.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from math import inf, nan
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import common
from mavstack.dialects.enums import official_names
from mavstack.errors import ActionUnsupported, RemoteError
from mavstack.node.api_object import LoopBound
from mavstack.vehicle.firmware.changes import Changes
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects import Message
    from mavstack.dialects.enums import MavEnum
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.services.setpoints import Setpoint
    from mavstack.services.version import AutopilotVersion, FirmwareVersion
    from mavstack.vehicle.geography import Location
    from mavstack.vehicle.vehicle import Vehicle

CMD: Final = common.MavCmd
FRAME: Final = common.MavFrame
_STANDARD: Final = common.MavStandardMode
_PREARM: Final = common.MavSysStatusSensor.PREARM_CHECK
#: Param 2 of DO_REPOSITION: the vehicle changes its mode for the command.
CHANGE_MODE: Final = float(common.MavDoRepositionFlags.CHANGE_MODE)
#: The wording of calls in errors, for calls that some vehicle types lack.
WORDS: Final[Mapping[str, str]] = MappingProxyType(
    {"takeoff": "take off", "land": "land", "rtl": "return by itself", "orbit": "orbit"}
)
#: The vehicle types that do not fly.
GROUNDED: Final = frozenset(kind for kind in VehicleType if not kind.flies)
_ACTUATORS_PER_SET: Final = 6
#: Timeout of a request for a parameter or a message before an action, in seconds.
REQUEST_TIMEOUT: Final = 3.0
#: The fraction by which the radius of a circle may differ from the requested radius.
_CIRCLE_DEVIATION: Final = 0.1
#: Param 2 of DO_MOTOR_TEST: the throttle is in percent.
_PERCENT: Final = float(common.MotorTestThrottleType.THROTTLE_PERCENT)


@dataclass(frozen=True, slots=True)
class OrbitEntry:
    """Where an orbit begins, and the heading in degrees that the vehicle needs there; None: any."""

    location: Location
    heading: float | None = None


class Firmware(LoopBound):
    """The firmware of one vehicle; made by `firmware_of`."""

    #: The modes in which each action continues, in lower case; a missing action continues in any mode.
    MODES: ClassVar[Mapping[str, frozenset[str]]] = MappingProxyType({})
    #: The name of the firmware; empty if it is not known.
    NAME: ClassVar[str] = ""
    #: The modes that end on the ground, in lower case.
    LANDING_MODES: ClassVar[frozenset[str]] = frozenset({"rtl", "land", "qrtl", "qland", "auto_rtl"})
    #: The modes in which the firmware does not arm, in lower case, by vehicle type; a type that is missing
    #: arms in all of its modes.
    NO_ARMING_MODES: ClassVar[Mapping[VehicleType, frozenset[str]]] = MappingProxyType({})
    #: The modes in which an armed vehicle on the ground starts to fly or drive without a further command.
    SELF_STARTING_MODES: ClassVar[Mapping[VehicleType, frozenset[str]]] = MappingProxyType(
        dict.fromkeys(VehicleType, frozenset({"takeoff", "mission", "auto", "rtl", "return", "offboard"}))
    )
    #: The mode in which each vehicle type waits on the ground when it is armed; empty: none is known.
    WAITING_MODES: ClassVar[Mapping[VehicleType, str]] = MappingProxyType({})

    #: The modes in which each vehicle type stays where it is; the other types use a command, or "LOITER".
    HOLD_MODES: ClassVar[Mapping[VehicleType, str]] = MappingProxyType({})
    #: The modes in which each vehicle type lands where it is; the other types use a command, or "LAND".
    LAND_MODES: ClassVar[Mapping[VehicleType, str]] = MappingProxyType({})

    #: The commands of the firmware's dialect.
    COMMANDS: ClassVar[type[MavEnum]] = common.MavCmd
    #: The message that reports the state estimator's health.
    ESTIMATOR_MESSAGE: ClassVar[type[Message]] = common.EstimatorStatus
    #: Prefixes of the status texts that name a failed check before arming.
    PREARM_PREFIXES: ClassVar[tuple[str, ...]] = ("PreArm: ", "Arm: ", "Preflight Fail: ", "Arming denied: ")
    #: Status texts that say only that there are failed checks.
    PREARM_EMPTY_TEXTS: ClassVar[frozenset[str]] = frozenset({"Resolve system health failures first"})
    #: Status texts of one run of the checks arrive within this time, in seconds.
    PREARM_RUN: ClassVar[float] = 60.0
    #: Failed checks are reported again within this time, in seconds; older texts are out of date.
    PREARM_LIFETIME: ClassVar[float] = inf

    #: True if RAW_IMU has the units of SCALED_IMU.
    RAW_IMU_IS_SCALED: ClassVar[bool] = False
    #: True if HIGH_LATENCY2's wind heading is the direction that the wind blows to.
    HIGH_LATENCY_WIND_TO: ClassVar[bool] = False
    #: True if the heartbeat shows whether the vehicle is in the air.
    HEARTBEAT_SHOWS_IN_AIR: ClassVar[bool] = False
    #: The features that every vehicle of the firmware has (True) or lacks (False).
    FEATURES: ClassVar[Mapping[str, bool]] = MappingProxyType({})
    #: The parameters that enable a piece of equipment, by its name.
    EQUIPMENT_PARAMETERS: ClassVar[Mapping[str, tuple[str, ...]]] = MappingProxyType({})
    #: The calls that no vehicle of the firmware supports, and their wording in errors: "takeoff": "take off".
    LACKING: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: The parameters that set the distance in metres at which a vehicle type stops before a target, with
    #: their usual values.
    STOPPING_RADII: ClassVar[Mapping[VehicleType, Mapping[str, float]]] = MappingProxyType({})
    #: The vehicle types that lack a call with this firmware, by call.
    LACKING_TYPES: ClassVar[Mapping[str, frozenset[VehicleType]]] = MappingProxyType({})
    #: The longest motor test that one command starts, in seconds.
    MAX_MOTOR_TEST: ClassVar[float] = inf
    #: True if the acceleration of a setpoint with a position and a velocity is added to the vehicle's own;
    #: others ignore it, or the whole setpoint.
    FOLLOWS_ACCELERATION: ClassVar[bool] = False
    #: True if the heartbeat of a vehicle says that it is armed while a motor is tested.
    MOTOR_TEST_ARMS: ClassVar[bool] = False

    def __init__(self, vehicle: Vehicle, changes: Changes | None = None) -> None:
        self.vehicle = vehicle
        #: The changes that were made by the steps of the present call.
        self.changes = Changes(vehicle) if changes is None else changes

    @classmethod
    def named_command(cls, number: int) -> int:
        """Return a MAV_CMD as a member of the firmware's commands, which has a name; others unchanged."""
        return cls.COMMANDS(number) if int(number) in official_names(cls.COMMANDS) else number

    # Reports of the vehicle's state

    @staticmethod
    def reports_prearm_check(status: common.SysStatus) -> bool:
        """Return whether a SYS_STATUS without a healthy pre-arm bit means that the vehicle is not ready."""
        return bool(
            (status.onboard_control_sensors_present | status.onboard_control_sensors_enabled) & _PREARM
        )

    @staticmethod
    def high_latency_armed(summary: common.HighLatency2) -> bool | None:
        """Return the armed state that a HIGH_LATENCY2 holds; None if it holds none."""
        del summary
        return None

    @staticmethod
    def high_latency_mode(custom_mode: int) -> int:
        """Return the custom mode for the one that a HIGH_LATENCY2 holds, which has 16 bits."""
        return custom_mode

    @staticmethod
    def in_air(info: ComponentInfo) -> bool | None:
        """Return whether a heartbeat means that the vehicle flies; None if it leaves that open."""
        del info
        return None

    @staticmethod
    def has_bootloader(version: AutopilotVersion) -> bool:
        """Return whether the board has a bootloader: it has a USB identity, which simulated ones lack."""
        return bool(version.vendor_id)

    def check_supported(self, call: str) -> None:
        """Raise `ActionUnsupported` if the firmware or the vehicle type lacks a call; asks no vehicle."""
        words = self.LACKING.get(call)
        if words is not None:
            raise self.unsupported(words, "its firmware has no command for that")
        if self.vehicle.vehicle_type in self.LACKING_TYPES.get(call, ()):
            raise self.unsupported(WORDS[call])

    @property
    def can_orbit(self) -> bool:
        """True if vehicles of this type circle locations with this firmware."""
        return self.vehicle.vehicle_type.flies

    def check_setpoint(self, setpoint: Setpoint) -> None:
        """Raise `ActionUnsupported` if the vehicle ignores setpoints of a type; does not ask the vehicle."""

    def adapt_setpoint(self, setpoint: Setpoint) -> Setpoint:
        """Return an equal setpoint in a frame that the firmware follows exactly."""
        return setpoint

    async def reason_against_takeoff(self, altitude: float) -> str | None:
        """Return why an armed vehicle cannot take off now, and what to do; may read parameters."""
        del altitude
        return None

    async def check_circle(self, radius: float, *, orbit: bool) -> None:
        """Raise `ActionUnsupported` if a wing cannot circle with a radius in metres; may read parameters.

        Args:
            radius: Negative: counter-clockwise.
            orbit: True for `orbit`, False for the circle at the end of `goto`.
        """

    @classmethod
    def modes_of(cls, action: str) -> frozenset[str] | None:
        """Return the modes in which an action goes on, in lower case; None if any mode will do."""
        return cls.MODES.get(action)

    def lands_in(self, mode: str | None) -> bool:
        """Return whether the vehicle lands in a mode."""
        name = (mode or "").lower()
        # A plane that has returned in RTL circles home until it gets another command.
        circles = name == "rtl" and self.vehicle.vehicle_type is VehicleType.PLANE
        return name in self.LANDING_MODES and not circles

    # Arming

    def allows_arming(self, mode: str | None) -> bool:
        """Return whether the firmware arms in a mode; True if that is not known."""
        return (mode or "").lower() not in self.NO_ARMING_MODES.get(self.vehicle.vehicle_type, ())

    def starts_by_itself(self, mode: str | None) -> bool:
        """Return whether a vehicle that is armed in a mode starts to fly or drive without a command."""
        return (mode or "").lower() in self.SELF_STARTING_MODES.get(self.vehicle.vehicle_type, ())

    @property
    def waiting_mode(self) -> str:
        """The mode in which the vehicle waits on the ground when it is armed; empty: none is known."""
        return self.WAITING_MODES.get(self.vehicle.vehicle_type, "")

    # Actions

    async def takeoff(self, altitude: float) -> None:
        """Take off to an altitude in metres above home, and stay there."""
        await self.command(CMD.NAV_TAKEOFF, nan, 0, 0, nan, nan, nan, await self.above_sea(altitude))

    async def land(self) -> None:
        """Land at the present position."""
        await self.command(CMD.NAV_LAND, 0, 0, 0, nan, nan, nan, nan)

    async def rtl(self) -> None:
        """Return to home."""
        await self.command(CMD.NAV_RETURN_TO_LAUNCH)

    async def hold(self) -> None:
        """Stay at the present position."""
        await self.changes.set_standard_mode(_STANDARD.POSITION_HOLD)

    async def guide(self) -> None:
        """Follow setpoints from now on."""
        raise self.unsupported("follow setpoints", "its firmware has no standard mode for that")

    async def goto(self, location: Location, *, yaw: float | None, radius: float | None) -> None:
        """Go to a location; yaw in degrees, `radius` in metres is that of a wing's circle around it."""
        altitude = nan if location.altitude is None else await self.above_sea(location.altitude)
        heading = nan if yaw is None else self.yaw_of(yaw)
        await self.command(
            CMD.DO_REPOSITION, -1, CHANGE_MODE, 0.0 if radius is None else radius, heading,
            location.latitude, location.longitude, altitude, frame=FRAME.GLOBAL,
        )  # fmt: skip

    async def prepare_orbit(self, center: Location, radius: float) -> OrbitEntry | None:
        """Return where the vehicle has to be before `orbit` is called; None if it may be anywhere."""
        del center, radius
        return None

    async def orbit(self, center: Location, *, radius: float, speed: float | None) -> None:
        """Circle a location with a radius in metres (negative: counter-clockwise) at a speed in m/s."""
        altitude = nan if center.altitude is None else await self.above_sea(center.altitude)
        yaw = float(common.OrbitYawBehaviour.HOLD_FRONT_TO_CIRCLE_CENTER)
        await self.command(
            CMD.DO_ORBIT, radius, nan if speed is None else speed, yaw, nan,
            center.latitude, center.longitude, altitude, frame=FRAME.GLOBAL,
        )  # fmt: skip

    async def turn(self, heading: float) -> None:
        """Turn to a heading in degrees clockwise from north."""
        await self.command(CMD.CONDITION_YAW, heading, 0, 0, 0)

    def needs_position(self, mode: str | None) -> bool:
        """Return whether arming in a mode needs an estimated position; None: the mode of the actions here."""
        del mode
        return False

    async def leave_stick_mode(self) -> None:
        """Leave a mode that needs the sticks of a radio control, if the vehicle is in one."""

    async def start_mission(self) -> None:
        """Fly the mission."""
        await self.changes.set_standard_mode(_STANDARD.MISSION)

    async def pause_mission(self) -> None:
        """Stay at the present position; `start_mission` resumes the mission."""
        await self.hold()

    # Payload and outputs

    async def look_at(self, location: Location) -> None:
        """Keep pointing at a location."""
        altitude = await self.above_sea(location.altitude or 0.0)
        await self.command(
            CMD.DO_SET_ROI_LOCATION, 0, 0, 0, 0, location.latitude, location.longitude, altitude,
            frame=FRAME.GLOBAL,
        )  # fmt: skip

    async def look_at_next_waypoint(self, pitch: float, roll: float, yaw: float) -> None:
        """Keep pointing at the next waypoint, turned by angles in degrees."""
        await self.command(CMD.DO_SET_ROI_WPNEXT_OFFSET, 0, 0, 0, 0, pitch, roll, yaw)

    async def look_ahead(self) -> None:
        """Point ahead again."""
        await self.command(CMD.DO_SET_ROI_NONE)

    async def set_servo(self, number: int, pulse: int) -> None:
        """Set the pulse of a servo output, in microseconds."""
        await self.command(CMD.DO_SET_SERVO, number, pulse)

    async def set_relay(self, number: int, *, on: bool) -> None:
        """Switch a relay."""
        await self.command(CMD.DO_SET_RELAY, number, float(on))

    async def set_actuator(self, number: int, value: float) -> None:
        """Set an actuator to a value of -1 to 1."""
        index, position = divmod(number - 1, _ACTUATORS_PER_SET)
        values = [nan] * _ACTUATORS_PER_SET
        values[position] = value
        await self.command(CMD.DO_SET_ACTUATOR, *values, index)

    async def test_motor(self, number: int, throttle: float, seconds: float) -> None:
        """Run a motor at a throttle in percent."""
        await self.command(CMD.DO_MOTOR_TEST, number, _PERCENT, throttle, seconds, 1)

    def stop_motor(self, number: int) -> None:
        """End the test of a motor, without waiting for an answer."""
        self.vehicle.component.send(
            common.CommandLong(command=CMD.DO_MOTOR_TEST, param1=number, param2=_PERCENT, param5=1)
        )

    async def set_ekf_source(self, number: int) -> None:
        """Select a set of sources of the state estimator."""
        del number
        raise self.unsupported("change the sources of its estimator", "its firmware has no source sets")

    # Parts of actions

    async def read_number(self, name: str) -> float | None:
        """Return a parameter, read from the vehicle if it is not known; None if it does not answer."""
        params = self.vehicle.params
        if name not in params.cached:
            with suppress(RemoteError):
                await params.get(name, timeout=REQUEST_TIMEOUT)
        found = params.cached.get(name)
        return None if found is None else float(found.value)

    async def read_flight_version(self) -> FirmwareVersion | None:
        """Return the version of the firmware, requested if it is not known; None if it is not told."""
        if self.vehicle.version is None:
            with suppress(RemoteError):
                await self.vehicle.component.get_version(timeout=REQUEST_TIMEOUT)
        version = self.vehicle.version
        return None if version is None or not version.flight.major else version.flight

    async def _check_parameter_circle(self, radius: float, name: str, firmware: str) -> None:
        """Raise unless a circle is about the one that a parameter sets, where commands have no radius."""
        value = await self.read_number(name)
        if value is None or abs(abs(value) - abs(radius)) <= max(_CIRCLE_DEVIATION * abs(radius), 1.0):
            return
        reason = f"{firmware} ignores the radius and circles at {name}, {abs(value):g} m; set that parameter"
        raise self.unsupported(f"circle with a radius of {abs(radius):g} m", reason)

    def yaw_of(self, heading: float) -> float:
        """Return a heading in degrees as DO_REPOSITION needs it, in radians from -pi to pi."""
        return (heading + 180.0) % 360.0 / 180.0 * 3.141592653589793 - 3.141592653589793

    async def above_sea(self, altitude: float) -> float:
        """Return metres above home as metres above mean sea level."""
        return altitude + await self.vehicle.get_home_altitude()

    async def command(self, command: int, *params: float, frame: int | None = None) -> None:
        """Send a command to the autopilot."""
        self.changes.requested = True
        await self.vehicle.component.command(command, *params, frame=frame)

    def unsupported(self, action: str, reason: str | None = None) -> ActionUnsupported:
        """Return the error for an action that the vehicle type or the firmware lacks."""
        why = f"it is a {self.vehicle.vehicle_type}" if reason is None else reason
        return ActionUnsupported(f"vehicle {self.vehicle.address} cannot {action}: {why}")
