"""PX4: altitudes above mean sea level, and commands that change the mode by themselves."""

from __future__ import annotations

from dataclasses import replace
from math import nan
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import common
from mavstack.services.setpoints import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint
from mavstack.vehicle.firmware.firmware import CHANGE_MODE, CMD, FRAME, GROUNDED, Firmware
from mavstack.vehicle.vehicle_type import VehicleType, flies_on_wing

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.services.setpoints import Setpoint
    from mavstack.vehicle.geography import Location

_HOLD = frozenset({"loiter"})
#: Modes that a pilot flies with sticks.
_STICK_MODES = frozenset(
    {"manual", "altctl", "posctl", "position_slow", "acro", "stabilized", "rattitude", "simple"}
    | {"altitude_cruise"}
)
#: HIGH_LATENCY2 holds the upper half of the custom mode: the main mode and the sub mode.
_CUSTOM_MODE_SHIFT = 16
_NO_VELOCITIES: Final = (
    "on its wing it follows positions and attitudes; begin with guided(first=...) that is one of these"
)
_FIRST_MOTOR: Final = int(common.ActuatorOutputFunction.MOTOR1)


class Px4(Firmware):
    """A vehicle that runs PX4."""

    NAME: ClassVar[str] = "PX4"
    FOLLOWS_ACCELERATION: ClassVar[bool] = True
    MODES: ClassVar[Mapping[str, frozenset[str]]] = MappingProxyType(
        {
            "takeoff": frozenset({"takeoff", "vtol_takeoff"}) | _HOLD,
            "land": frozenset({"land"}),
            "rtl": frozenset({"rtl"}),
            "goto": _HOLD,
            "orbit": frozenset({"orbit"}) | _HOLD,
            "turn": _HOLD,
            "guided": frozenset({"offboard"}),
            # A mission that ends with a return or a landing continues in the mode RTL or LAND.
            "mission": frozenset({"mission", "rtl", "land"}),
            "end of mission": _HOLD,
        }
    )
    LACKING_TYPES: ClassVar[Mapping[str, frozenset[VehicleType]]] = MappingProxyType(
        dict.fromkeys(("takeoff", "land", "orbit"), GROUNDED)
    )
    #: The modes that PX4 marks as `mode_req_prevent_arming`.
    NO_ARMING_MODES: ClassVar[Mapping[VehicleType, frozenset[str]]] = MappingProxyType(
        dict.fromkeys(
            VehicleType,
            frozenset({"rtl", "land", "precland", "descend", "orbit", "termination", "follow_target"}),
        )
    )
    SELF_STARTING_MODES: ClassVar[Mapping[VehicleType, frozenset[str]]] = MappingProxyType(
        dict.fromkeys(VehicleType, frozenset({"takeoff", "vtol_takeoff", "mission", "offboard"}))
    )
    WAITING_MODES: ClassVar[Mapping[VehicleType, str]] = MappingProxyType(
        dict.fromkeys(VehicleType, "LOITER")
    )
    FEATURES: ClassVar[Mapping[str, bool]] = MappingProxyType(
        dict.fromkeys(
            ("parameters", "mission", "logs", "shell", "actuators", "motor_test", "manual_control"), True
        )
        | {"failures": True, "flashing": True, "servos": False, "relays": False, "ekf_sources": False}
    )
    EQUIPMENT_PARAMETERS: ClassVar[Mapping[str, tuple[str, ...]]] = MappingProxyType(
        {"gripper": ("PD_GRIPPER_EN",), "osd": ("OSD_ATXXXX_CFG", "MSP_OSD_CONFIG")}
    )
    STOPPING_RADII: ClassVar[Mapping[VehicleType, Mapping[str, float]]] = MappingProxyType(
        {kind: {"NAV_ACC_RAD": 0.5} for kind in (VehicleType.ROVER, VehicleType.BOAT)}
    )
    HIGH_LATENCY_WIND_TO: ClassVar[bool] = True
    #: PX4 shortens longer tests to this time, so that a motor stops soon after contact is lost.
    MAX_MOTOR_TEST: ClassVar[float] = 3.0

    @staticmethod
    def reports_prearm_check(status: common.SysStatus) -> bool:
        """Return True: PX4 never marks the check as present, but sets its health bit."""
        del status
        return True

    @staticmethod
    def high_latency_mode(custom_mode: int) -> int:
        return custom_mode << _CUSTOM_MODE_SHIFT

    async def takeoff(self, altitude: float) -> None:
        if not self.vehicle.vehicle_type.flies:
            raise self.unsupported("take off")
        await super().takeoff(altitude)

    async def land(self) -> None:
        if not self.vehicle.vehicle_type.flies:
            raise self.unsupported("land")
        await super().land()

    async def hold(self) -> None:
        await self.changes.set_mode("LOITER")

    async def guide(self) -> None:
        await self.changes.set_mode("OFFBOARD")

    async def leave_stick_mode(self) -> None:
        """Enter the hold mode, in which PX4 can be armed without radio control."""
        if (self.vehicle.mode or "").lower() in _STICK_MODES:
            await self.hold()

    async def orbit(self, center: Location, *, radius: float, speed: float | None) -> None:
        if not self.vehicle.vehicle_type.flies:
            raise self.unsupported("orbit")
        await super().orbit(center, radius=radius, speed=speed)

    def check_setpoint(self, setpoint: Setpoint) -> None:
        """Raise if a wing ignores a setpoint: it follows attitudes and whole positions, no velocities."""
        vehicle = self.vehicle
        on_wing = flies_on_wing(vehicle.vehicle_type, vehicle.vtol_state)
        if isinstance(setpoint, AttitudeSetpoint) or not on_wing:
            return
        if None in _position_of(setpoint):
            raise self.unsupported("follow setpoints of velocities", _NO_VELOCITIES)

    def adapt_setpoint(self, setpoint: Setpoint) -> Setpoint:
        """Return an altitude above home as one above mean sea level, if a position shows the height of home.

        PX4 (1.17) adds the difference between home and the origin of its local frame with the wrong sign to
        altitudes above home.
        """
        if not isinstance(setpoint, GlobalSetpoint) or setpoint.frame != common.MavFrame.GLOBAL_RELATIVE_ALT:
            return setpoint
        place = self.vehicle.position
        if setpoint.altitude is None or place is None:
            return setpoint
        if place.altitude is None or place.relative_altitude is None:
            return setpoint
        altitude = setpoint.altitude + place.altitude - place.relative_altitude
        return replace(setpoint, altitude=altitude, frame=common.MavFrame.GLOBAL)

    async def check_circle(self, radius: float, *, orbit: bool) -> None:
        """Raise for a radius in `goto`, which DO_REPOSITION ignores; DO_ORBIT has one."""
        vehicle = self.vehicle
        if not orbit and flies_on_wing(vehicle.vehicle_type, vehicle.vtol_state):
            await self._check_parameter_circle(radius, "NAV_LOITER_RAD", "PX4")

    async def turn(self, heading: float) -> None:
        """Turn by a DO_REPOSITION to the present position: PX4 takes CONDITION_YAW in missions only."""
        if self.vehicle.vehicle_type is VehicleType.PLANE:
            raise self.unsupported("turn on the spot")
        yaw = self.yaw_of(heading)
        await self.command(CMD.DO_REPOSITION, -1, CHANGE_MODE, 0, yaw, nan, nan, nan, frame=FRAME.GLOBAL)

    async def start_mission(self) -> None:
        await self.changes.set_mode("MISSION")

    async def set_servo(self, number: int, pulse: int) -> None:
        raise self.unsupported("set a servo", "PX4 numbers its outputs as actuators; use set_actuator")

    async def set_relay(self, number: int, *, on: bool) -> None:
        raise self.unsupported("switch a relay", "PX4 has none")

    async def test_motor(self, number: int, throttle: float, seconds: float) -> None:
        function = _FIRST_MOTOR + number - 1
        await self.command(CMD.ACTUATOR_TEST, throttle / 100.0, seconds, 0, 0, function)

    def stop_motor(self, number: int) -> None:
        function = _FIRST_MOTOR + number - 1
        self.vehicle.component.send(common.CommandLong(command=CMD.ACTUATOR_TEST, param5=function))


def _position_of(setpoint: LocalSetpoint | GlobalSetpoint) -> tuple[float | None, ...]:
    if isinstance(setpoint, LocalSetpoint):
        return setpoint.position
    return setpoint.latitude, setpoint.longitude, setpoint.altitude
