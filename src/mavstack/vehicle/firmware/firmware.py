"""How a firmware wants to be asked: this one keeps to commands and modes that the standard names.

A vehicle is asked for an action by one of these; what follows, seeing it through, is the same for all and not
here. `MODES` names the mode in which an action goes on; all modes of an action are those in which it is not
interrupted.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, Final

from mavstack.dialects import common
from mavstack.errors import ActionUnsupported
from mavstack.vehicle.actions.home import home_altitude

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.vehicle.vehicle import Vehicle

CMD: Final = common.MavCmd
FRAME: Final = common.MavFrame
_STANDARD: Final = common.MavStandardMode
#: DO_REPOSITION: change the mode for it.
CHANGE_MODE: Final = float(common.MavDoRepositionFlags.CHANGE_MODE)


@dataclass(frozen=True, slots=True)
class Place:
    """Where to go: degrees, and metres above home."""

    latitude: float
    longitude: float
    altitude: float | None = None


class Firmware:
    """One vehicle's firmware; made by `firmware_of`."""

    #: Modes by action, lower-cased; an action that is not named goes on in any mode.
    MODES: ClassVar[Mapping[str, frozenset[str]]] = MappingProxyType({})

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle

    def modes_of(self, action: str) -> frozenset[str] | None:
        """The modes in which an action goes on; None if any will do."""
        return self.MODES.get(action)

    # What it can be asked

    async def takeoff(self, altitude: float) -> None:
        """Rise to so many metres above home and stay there."""
        await self.command(CMD.NAV_TAKEOFF, nan, 0, 0, nan, nan, nan, await self.above_sea(altitude))

    async def land(self) -> None:
        """Land here."""
        await self.command(CMD.NAV_LAND, 0, 0, 0, nan, nan, nan, nan)

    async def rtl(self) -> None:
        """Return home."""
        await self.command(CMD.NAV_RETURN_TO_LAUNCH)

    async def hold(self) -> None:
        """Stay here."""
        await self.set_standard_mode(_STANDARD.POSITION_HOLD)

    async def guide(self) -> None:
        """Follow setpoints from now on."""
        raise self.unsupported("follow setpoints")

    async def goto(self, place: Place, *, yaw: float | None, radius: float | None) -> None:
        """Go to a place; yaw in degrees, the radius is that of the circle that a wing flies there."""
        altitude = nan if place.altitude is None else await self.above_sea(place.altitude)
        turned = nan if yaw is None else self.yaw_of(yaw)
        around = 0.0 if radius is None else radius
        await self.command(
            CMD.DO_REPOSITION, -1, CHANGE_MODE, around, turned, place.latitude, place.longitude, altitude,
            frame=FRAME.GLOBAL,
        )  # fmt: skip

    async def orbit(self, place: Place, *, radius: float, speed: float | None) -> None:
        """Circle a place, the other way round if the radius is negative."""
        altitude = nan if place.altitude is None else await self.above_sea(place.altitude)
        yaw = float(common.OrbitYawBehaviour.HOLD_FRONT_TO_CIRCLE_CENTER)
        tangent = nan if speed is None else speed
        await self.command(
            CMD.DO_ORBIT, radius, tangent, yaw, nan, place.latitude, place.longitude, altitude,
            frame=FRAME.GLOBAL,
        )  # fmt: skip

    async def turn(self, heading: float) -> None:
        """Turn to a heading in degrees."""
        await self.command(CMD.CONDITION_YAW, heading, 0, 0, 0)

    async def become_armable(self) -> None:
        """Leave a mode in which it does not let itself be armed, such as the one that it landed in."""

    async def start_mission(self) -> None:
        """Fly the mission, armed or to be armed."""
        await self.set_standard_mode(_STANDARD.MISSION)

    async def pause_mission(self) -> None:
        """Wait where it is; `start_mission` goes on."""
        await self.hold()

    # What these are made of

    def yaw_of(self, degrees: float) -> float:
        """A heading as DO_REPOSITION wants it, which is in radians."""
        return (degrees + 180.0) % 360.0 / 180.0 * 3.141592653589793 - 3.141592653589793

    async def above_sea(self, altitude: float) -> float:
        """Metres above home as metres above mean sea level."""
        return altitude + await home_altitude(self.vehicle)

    async def command(self, command: int, *params: float, frame: int | None = None) -> None:
        """Have the vehicle carry out a command."""
        await self.vehicle.component.command(command, *params, frame=frame)

    async def set_standard_mode(self, mode: int) -> None:
        """Enter a MAV_STANDARD_MODE."""
        await self.vehicle.component.modes.set_standard(mode)

    async def set_mode(self, mode: str) -> None:
        """Enter a mode of its own."""
        await self.vehicle.component.modes.set(mode)

    def unsupported(self, action: str) -> ActionUnsupported:
        """What to raise for what this kind of vehicle cannot do."""
        return ActionUnsupported(
            f"a {self.vehicle.vehicle_type} cannot {action} (asked of {self.vehicle.address})"
        )
