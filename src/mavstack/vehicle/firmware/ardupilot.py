"""ArduPilot: modes rather than commands, altitudes above home, and one set of modes for each class of
vehicle.
"""

from __future__ import annotations

from math import degrees
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import common
from mavstack.errors import ActionUnsupported, CommandDenied, ParameterDenied, ParameterTimeout
from mavstack.services.setpoints import GlobalSetpoint
from mavstack.vehicle.actions.home import find_altitude
from mavstack.vehicle.firmware.firmware import CHANGE_MODE, CMD, FRAME, Firmware, Place
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Mapping

_GUIDED: Final = frozenset({"guided"})
#: Where each class stays when it is told to: modes that need no pilot's throttle, where there is such a one.
_HOLDING: Final[Mapping[VehicleType, str]] = MappingProxyType(
    {
        VehicleType.COPTER: "BRAKE",
        VehicleType.PLANE: "LOITER",
        VehicleType.VTOL: "LOITER",
        VehicleType.ROVER: "HOLD",
        VehicleType.BOAT: "LOITER",
        VehicleType.SUB: "POSHOLD",
    }
)
#: In these a copter or a rover cannot be armed, though it stays in them when it has come home.
_NOT_ARMABLE: Final = frozenset({"rtl", "smart_rtl", "land", "brake", "circle"})
_LANDING: Final[Mapping[VehicleType, str]] = MappingProxyType(
    {VehicleType.COPTER: "LAND", VehicleType.VTOL: "QLAND"}
)
#: CIRCLE_OPTIONS: the circle's centre is where the mode is entered.
_CENTRE_IS_HERE: Final = 4
_CENTIMETRES: Final = 100.0
#: The throttle's channel, where RCMAP_THROTTLE does not say else, its middle, how far from it is still it.
_THROTTLE: Final = 3
_MIDDLE: Final = 1500
_DEAD_ZONE: Final = 100


class ArduPilot(Firmware):
    """A vehicle that ArduPilot flies or drives."""

    MODES: ClassVar[Mapping[str, frozenset[str]]] = MappingProxyType(
        {
            "takeoff": _GUIDED | {"takeoff"},
            # A plane lands in AUTO, by its mission.
            "land": frozenset({"land", "qland", "auto", "auto_rtl"}),
            "rtl": frozenset({"rtl", "qrtl", "smart_rtl", "auto_rtl", "auto"}),
            "goto": _GUIDED,
            "orbit": _GUIDED | {"circle"},
            "turn": _GUIDED,
            "guided": _GUIDED,
            "mission": frozenset({"auto", "auto_rtl", "rtl", "qrtl"}),
        }
    )

    @property
    def kind(self) -> VehicleType:
        """The class of the vehicle."""
        return self.vehicle.vehicle_type

    async def takeoff(self, altitude: float) -> None:
        if not self.kind.flies:
            raise self.unsupported("take off")
        if self.kind is VehicleType.PLANE:
            await self.vehicle.params.set("TKOFF_ALT", altitude)
            await self.set_mode("TAKEOFF")
            return
        await self.set_mode("GUIDED")
        await self.command(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, altitude)

    async def land(self) -> None:
        """Land here; a plane lands where its mission says, as it has no other way."""
        if self.kind is VehicleType.PLANE:
            await self.command(CMD.DO_LAND_START)
        elif self.kind in _LANDING:
            await self.set_mode(_LANDING[self.kind])
        else:
            raise self.unsupported("land")

    async def rtl(self) -> None:
        if self.kind is VehicleType.SUB:
            raise self.unsupported("return by itself")
        await self.set_mode("RTL")

    async def hold(self) -> None:
        await self.set_mode(_HOLDING.get(self.kind, "LOITER"))

    async def guide(self) -> None:
        await self.set_mode("GUIDED")

    async def goto(self, place: Place, *, yaw: float | None, radius: float | None) -> None:
        """By DO_REPOSITION, and by a setpoint where that is not known, which older versions do not."""
        await self.set_mode("GUIDED")
        altitude = place.altitude
        if altitude is None:
            altitude = await find_altitude(self.vehicle)
        turned = 0.0 if yaw is None else self.yaw_of(yaw)
        if self.kind in (VehicleType.PLANE, VehicleType.VTOL):
            turned = 0.0  # there it is the direction of the circle
        try:
            await self.command(
                CMD.DO_REPOSITION, -1, CHANGE_MODE, radius or 0.0, turned,
                place.latitude, place.longitude, altitude, frame=FRAME.GLOBAL_RELATIVE_ALT,
            )  # fmt: skip
        except CommandDenied as error:
            if error.code != common.MavResult.UNSUPPORTED:
                raise
            there = GlobalSetpoint(place.latitude, place.longitude, altitude)
            self.vehicle.component.send(there.to_message(self.vehicle.address))
        if yaw is not None and self.kind is VehicleType.COPTER:
            await self.turn(yaw)

    async def orbit(self, place: Place, *, radius: float, speed: float | None) -> None:
        """A wing circles where it is sent; a copter flies to the centre, and circles it in CIRCLE."""
        if self.kind in (VehicleType.PLANE, VehicleType.VTOL):
            await self._loiter(place, radius)
        elif self.kind is VehicleType.COPTER:
            self._check_throttle()
            await self.vehicle.goto(place.latitude, place.longitude, place.altitude)
            await self._set_up_circle(radius, speed)
            await self.set_mode("CIRCLE")
        else:
            raise self.unsupported("orbit")

    async def turn(self, heading: float) -> None:
        """In GUIDED: elsewhere the command is accepted, and nothing turns."""
        if self.kind is VehicleType.PLANE:
            raise self.unsupported("turn on the spot")
        if (self.vehicle.mode or "").lower() not in _GUIDED:
            await self.guide()
        await self.command(CMD.CONDITION_YAW, heading % 360.0, 0, 0, 0)

    async def become_armable(self) -> None:
        mode = (self.vehicle.mode or "").lower()
        if mode in _NOT_ARMABLE or (mode == "auto" and self.kind is VehicleType.COPTER):
            await self.guide()

    async def start_mission(self) -> None:
        """AUTO, and on the ground the command to begin: a copter would wait for the pilot's throttle."""
        await self.set_mode("AUTO")
        if self.kind is not VehicleType.PLANE:
            await self.command(CMD.MISSION_START)

    def _check_throttle(self) -> None:
        """In CIRCLE a copter climbs and sinks by the pilot's throttle, if there is one."""
        rc, channel = self.vehicle.rc, self.vehicle.params.cached.get("RCMAP_THROTTLE")
        number = _THROTTLE if channel is None else int(channel.value)
        pulse = rc.channels[number - 1] if rc is not None and number <= len(rc.channels) else None
        if pulse is not None and abs(pulse - _MIDDLE) > _DEAD_ZONE:
            answer = (
                f"its throttle stick is at {pulse} us, and it would climb or sink by it; centre the stick"
            )
            raise ActionUnsupported(f"{self.vehicle.address} cannot orbit now: {answer}")

    async def _loiter(self, place: Place, radius: float) -> None:
        altitude = place.altitude
        if altitude is None:
            altitude = await find_altitude(self.vehicle)
        direction = 1.0 if radius < 0 else 0.0
        await self.set_mode("GUIDED")
        await self.command(
            CMD.DO_REPOSITION, -1, CHANGE_MODE, abs(radius), direction,
            place.latitude, place.longitude, altitude, frame=FRAME.GLOBAL_RELATIVE_ALT,
        )  # fmt: skip

    async def _set_up_circle(self, radius: float, speed: float | None) -> None:
        params = self.vehicle.params
        clockwise = 1.0 if radius > 0 else -1.0
        await params.set("CIRCLE_RADIUS", abs(radius) * _CENTIMETRES)
        if speed is None:  # as fast as it is set to, in this direction
            rate = abs(float((await params.get("CIRCLE_RATE")).value))
        else:
            rate = degrees(speed / abs(radius))
        await params.set("CIRCLE_RATE", clockwise * rate)
        try:
            options = int((await params.get("CIRCLE_OPTIONS")).value)
            await params.set("CIRCLE_OPTIONS", options | _CENTRE_IS_HERE)
        except (ParameterDenied, ParameterTimeout):
            return  # before it had that parameter, the centre was always here
