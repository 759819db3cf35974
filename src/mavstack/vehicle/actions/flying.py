"""Taking off, landing, returning, going somewhere: asked as the firmware wants it, and seen through.

When an action is done, what is heard of the vehicle says, not what its firmware acknowledged:

    takeoff   within a metre or a twentieth of the altitude
    land      on the ground and disarmed, or on the ground for a while
    rtl       the same; what does not land there: at home, within its circle
    goto      within the radius; a wing: on the circle around the place
    orbit     on the circle
    turn      within five degrees
"""

from __future__ import annotations

from contextlib import suppress
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import CommandDenied, LocalProtocolError, RemoteError
from mavstack.vehicle.action_monitor import PATIENCE, ActionGoal, ActionMonitor
from mavstack.vehicle.actions.home import find_home, find_position
from mavstack.vehicle.firmware.firmware import Place
from mavstack.vehicle.geography import distance, moved
from mavstack.vehicle.status_text_capture import with_status_texts
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from typing import Any

    from mavstack.vehicle.vehicle import Vehicle

#: As near as this is there: what hovers or drives, and what circles a place at the usual radius.
NEAR: Final = 2.0
NEAR_ON_WING: Final = 120.0
#: A circle around a place is as much wider than its radius at most.
AROUND: Final = 1.3
#: How near the circle of an orbit.
ON_CIRCLE: Final = 5.0
NEAR_IN_ALTITUDE: Final = 2.0
NEAR_ON_WING_IN_ALTITUDE: Final = 10.0
_DEGREES: Final = 5.0
#: A vehicle that is on the ground for so long and does not disarm has landed all the same.
STAYS_ARMED: Final = 15.0
#: One that circles home on its wing for so long does not mean to land: not every quadplane does.
STAYS_ON_WING: Final = 30.0
#: For so long a wing may keep its height before it lands, and a vehicle whose home is not known may return.
_ON_A_PATTERN: Final = 600.0
_ON_GROUND: Final = common.MavLandedState.ON_GROUND


async def _see_through(
    vehicle: Vehicle, asked: Coroutine[Any, Any, None], aim: Callable[[], ActionGoal], *, wait: bool
) -> None:
    try:
        async with ActionMonitor(vehicle) as watch:
            await with_status_texts(vehicle, asked)
            if wait:
                await watch.until(aim())
    finally:
        asked.close()  # if it was not come to


async def takeoff(vehicle: Vehicle, altitude: float, *, wait: bool, limit: float | None) -> None:
    """Rise to an altitude above home."""
    if not (isfinite(altitude) and altitude > 0):
        raise LocalProtocolError(f"nothing takes off to an altitude of {altitude} m")
    near = max(1.0, altitude / 20)

    def left() -> float | None:
        height = _height(vehicle)
        return None if height is None else abs(altitude - height)

    aim = ActionGoal(
        f"takeoff to {altitude:g} m",
        lambda: (rest := left()) is not None and rest <= near,
        left,
        modes=vehicle.firmware.modes_of("takeoff"),
        armed=True,
        limit=limit,
    )
    try:
        await _see_through(vehicle, vehicle.firmware.takeoff(altitude), lambda: aim, wait=wait)
    except CommandDenied as error:
        if vehicle.armed is False:
            error.status_texts = error.status_texts or ("it is disarmed",)  # for which ArduPilot has no text
        raise


async def land(vehicle: Vehicle, *, wait: bool, limit: float | None) -> None:
    """Land, and wait until the motors stand."""
    aim = ActionGoal(
        "landing",
        LandingDetector(vehicle).ended,
        lambda: _height(vehicle),
        modes=vehicle.firmware.modes_of("land"),
        limit=limit,
        patience=_ON_A_PATTERN if vehicle.vehicle_type is VehicleType.PLANE else PATIENCE,
    )
    await _see_through(vehicle, vehicle.firmware.land(), lambda: aim, wait=wait)


async def rtl(vehicle: Vehicle, *, wait: bool, limit: float | None) -> None:
    """Return home, and land there if that is what the vehicle does; where home is, it need not tell."""
    landing = LandingDetector(vehicle)
    stays = not vehicle.vehicle_type.flies or vehicle.vehicle_type is VehicleType.PLANE
    near = NEAR_ON_WING if vehicle.vehicle_type.circles else NEAR

    async def ask() -> None:
        await vehicle.firmware.rtl()
        if wait:
            with suppress(RemoteError):
                await find_home(vehicle)

    def from_home() -> float | None:
        home = vehicle.home
        return None if home is None else _away(vehicle, home.latitude, home.longitude)

    def left() -> float | None:
        away, height = from_home(), _height(vehicle)
        return None if away is None or height is None else away + abs(height)

    circling = SustainedCondition(vehicle, STAYS_ON_WING)

    def reached() -> bool:
        away = from_home()
        at_home = away is not None and away <= near
        landed = vehicle.vehicle_type.flies and landing.ended()
        return landed or (stays and at_home) or circling.goes_on(at_home and on_wing(vehicle))

    def aim() -> ActionGoal:
        patience = _ON_A_PATTERN if vehicle.home is None else 90.0
        modes = vehicle.firmware.modes_of("rtl")
        return ActionGoal("return", reached, left, modes=modes, limit=limit, patience=patience)

    await _see_through(vehicle, ask(), aim, wait=wait)


async def place_from_here(vehicle: Vehicle, north: float, east: float, up: float) -> Place:
    """The place so many metres from where the vehicle is."""
    here = await find_position(vehicle)
    latitude, longitude = moved(here.latitude, here.longitude, north, east)
    return Place(latitude, longitude, None if not up else (here.relative_altitude or 0.0) + up)


async def goto(
    vehicle: Vehicle,
    place: Place,
    *,
    yaw: float | None,
    radius: float | None,
    wait: bool,
    limit: float | None,
) -> None:
    """Go to a place and stay there."""
    _check_place(place)
    near_on_wing = NEAR_ON_WING if radius is None else radius * AROUND

    def off() -> tuple[float, float] | None:
        away, height = _away(vehicle, place.latitude, place.longitude), _height(vehicle)
        if away is None or height is None:
            return None
        return away, 0.0 if place.altitude is None else abs(place.altitude - height)

    def there() -> bool:
        near = (near_on_wing, NEAR_ON_WING_IN_ALTITUDE) if on_wing(vehicle) else (NEAR, NEAR_IN_ALTITUDE)
        rest = off()
        return rest is not None and rest[0] <= near[0] and rest[1] <= near[1]

    aim = ActionGoal(
        f"going to {place.latitude:.6f}, {place.longitude:.6f}",
        there,
        lambda: None if (rest := off()) is None else sum(rest),
        modes=vehicle.firmware.modes_of("goto"),
        armed=True,
        limit=limit,
    )
    asked = vehicle.firmware.goto(place, yaw=yaw, radius=radius)
    await _see_through(vehicle, asked, lambda: aim, wait=wait)


async def orbit(
    vehicle: Vehicle, place: Place, *, radius: float, speed: float | None, wait: bool, limit: float | None
) -> None:
    """Circle a place."""
    _check_place(place)
    if not (isfinite(radius) and radius):
        raise LocalProtocolError("a circle needs a radius; a negative one is flown counter-clockwise")
    near = max(ON_CIRCLE, abs(radius) / 4)

    def off() -> float | None:
        away = _away(vehicle, place.latitude, place.longitude)
        return None if away is None else abs(away - abs(radius))

    aim = ActionGoal(
        f"orbit of {abs(radius):g} m",
        lambda: (rest := off()) is not None and rest <= near,
        off,
        modes=vehicle.firmware.modes_of("orbit"),
        armed=True,
        limit=limit,
    )
    asked = vehicle.firmware.orbit(place, radius=radius, speed=speed)
    await _see_through(vehicle, asked, lambda: aim, wait=wait)


async def turn(vehicle: Vehicle, heading: float, *, wait: bool, limit: float | None) -> None:
    """Turn to a heading."""

    def left() -> float | None:
        position = vehicle.position
        if position is None or position.heading is None:
            return None
        return abs((position.heading - heading + 180.0) % 360.0 - 180.0)

    aim = ActionGoal(
        f"turning to {heading % 360:g} degrees",
        lambda: (rest := left()) is not None and rest <= _DEGREES,
        left,
        "degrees",
        modes=vehicle.firmware.modes_of("turn"),
        limit=limit,
    )
    await _see_through(vehicle, vehicle.firmware.turn(heading), lambda: aim, wait=wait)


async def hold(vehicle: Vehicle) -> None:
    """Stay here."""
    await with_status_texts(vehicle, vehicle.firmware.hold())


class SustainedCondition:
    """Whether something has been so for long."""

    def __init__(self, vehicle: Vehicle, seconds: float) -> None:
        self._now = vehicle.connection.now
        self._seconds = seconds
        self._since: float | None = None

    def goes_on(self, holds: bool) -> bool:
        """It is so now, or is not; whether it has been for long."""
        if not holds:
            self._since = None
            return False
        now = self._now()
        if self._since is None:
            self._since = now
        return now >= self._since + self._seconds


class LandingDetector:
    """Whether a vehicle that was in the air has landed."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._on_ground = SustainedCondition(vehicle, STAYS_ARMED)

    def ended(self) -> bool:
        """Disarmed, or on the ground for long."""
        on_ground = self._on_ground.goes_on(self._vehicle.landed_state == _ON_GROUND)
        return on_ground or self._vehicle.armed is False


def on_wing(vehicle: Vehicle) -> bool:
    """Whether it cannot stand still now."""
    hovers = vehicle.vtol_state == common.MavVtolState.MC
    return vehicle.vehicle_type is VehicleType.PLANE or (
        vehicle.vehicle_type is VehicleType.VTOL and not hovers
    )


def _height(vehicle: Vehicle) -> float | None:
    position = vehicle.position
    return None if position is None else position.relative_altitude


def _away(vehicle: Vehicle, latitude: float, longitude: float) -> float | None:
    position = vehicle.position
    if position is None:
        return None
    return distance(position.latitude, position.longitude, latitude, longitude)


def _check_place(place: Place) -> None:
    fits = abs(place.latitude) <= 90.0 and abs(place.longitude) <= 180.0
    if not (fits and isfinite(place.altitude or 0.0)):
        where = f"{place.latitude}, {place.longitude}, {place.altitude}"
        raise LocalProtocolError(f"{where} is no place on Earth")
