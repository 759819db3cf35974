"""PX4: commands with altitudes above the sea, and modes that commands bring along."""

from __future__ import annotations

from math import nan
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

from mavstack.vehicle.firmware.firmware import CHANGE_MODE, CMD, FRAME, Firmware
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Mapping

_HOLD = frozenset({"loiter"})


class Px4(Firmware):
    """A vehicle that PX4 flies or drives."""

    MODES: ClassVar[Mapping[str, frozenset[str]]] = MappingProxyType(
        {
            "takeoff": frozenset({"takeoff", "vtol_takeoff"}) | _HOLD,
            "land": frozenset({"land"}),
            "rtl": frozenset({"rtl"}),
            "goto": _HOLD,
            "orbit": frozenset({"orbit"}) | _HOLD,
            "turn": _HOLD,
            "guided": frozenset({"offboard"}),
            # A mission that ends with a return or a landing goes on in their modes.
            "mission": frozenset({"mission", "rtl", "land"}),
            "end of mission": _HOLD,
        }
    )

    async def takeoff(self, altitude: float) -> None:
        if not self.vehicle.vehicle_type.flies:
            raise self.unsupported("take off")
        await super().takeoff(altitude)

    async def land(self) -> None:
        if not self.vehicle.vehicle_type.flies:
            raise self.unsupported("land")
        await super().land()

    async def hold(self) -> None:
        await self.set_mode("LOITER")

    async def guide(self) -> None:
        await self.set_mode("OFFBOARD")

    async def orbit(self, place: object, **circle: object) -> None:
        if not self.vehicle.vehicle_type.flies:
            raise self.unsupported("orbit")
        await super().orbit(place, **circle)  # type: ignore[arg-type]

    async def turn(self, heading: float) -> None:
        """By DO_REPOSITION to where it is: PX4 takes CONDITION_YAW in missions alone."""
        if self.vehicle.vehicle_type is VehicleType.PLANE:
            raise self.unsupported("turn on the spot")
        yaw = self.yaw_of(heading)
        await self.command(CMD.DO_REPOSITION, -1, CHANGE_MODE, 0, yaw, nan, nan, nan, frame=FRAME.GLOBAL)

    async def start_mission(self) -> None:
        await self.set_mode("MISSION")
