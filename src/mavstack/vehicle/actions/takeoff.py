"""Taking off.

A takeoff is complete when a vehicle that hovers is within half a metre of the altitude and settled there, or
settled for longer within a metre or a twentieth of it; for a plane, from 3 metres or a sixteenth below it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.vehicle.action_monitor import ActionGoal
from mavstack.vehicle.actions.arrival import check_tolerance
from mavstack.vehicle.actions.conditions import Settled
from mavstack.vehicle.actions.limits import check_takeoff
from mavstack.vehicle.actions.preconditions import check_preconditions, refusal
from mavstack.vehicle.actions.quadplane import detect_quadplane
from mavstack.vehicle.actions.running import relative_altitude_of, run_action
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from mavstack.vehicle.vehicle import Vehicle

#: The distance to the takeoff altitude, in metres, within which a hovering vehicle has reached it.
TAKEOFF_TOLERANCE: Final = 0.5
#: A vehicle has settled when its altitude changed by less than the span (m) in the time (s).
#: `TAKEOFF_RESTING_TIME` is for a vehicle that settles farther from the altitude, because its estimate of
#: home drifts.
TAKEOFF_SETTLING_SPAN: Final = 0.3
TAKEOFF_SETTLING_TIME: Final = 1.0
TAKEOFF_RESTING_TIME: Final = 6.0


async def takeoff(
    vehicle: Vehicle,
    altitude: float = 10.0,
    *,
    tolerance: float | None = None,
    override_limits: bool = False,
    wait: bool = True,
    timeout: float | None = None,
) -> None:
    """Take off to an altitude and stay there; the vehicle must be armed.

    It ends when a vehicle that hovers has settled within half a metre of the altitude.

    Args:
        altitude: Metres above home.
        tolerance: Metres from the altitude within which a vehicle that hovers has settled, or by which a
            plane may be below it; None: as above, or a larger distance for a plane.
        override_limits: Send an altitude above the limit of plausible flights.
        wait: Wait until the altitude is reached and kept.
        timeout: Seconds for the whole call; None sets no overall limit.

    Raises:
        InvalidTypeError: An argument is not a number.
        InvalidArgumentError: The altitude is not positive, or implausibly high; or the tolerance is not
            positive.
        ActionRefused: The vehicle is not armed, or it flies and its firmware does not take off then
            (ArduPilot); nothing was sent.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    check_takeoff(altitude, override_limits=override_limits)
    check_tolerance(tolerance)
    operation = f"takeoff to {altitude:g} m of"
    check_preconditions(vehicle, "takeoff", operation)
    await detect_quadplane(vehicle)
    firmware = firmware_of(vehicle)
    if reason := await firmware.reason_against_takeoff(altitude):
        raise refusal(vehicle, operation, reason)
    climb = _Climb(vehicle, altitude, tolerance)
    goal = ActionGoal(climb.reached, climb.remaining, modes=firmware.modes_of("takeoff"), armed=True)
    request = firmware.takeoff(altitude)
    await run_action(
        vehicle, operation, request, lambda: goal, changes=firmware.changes, wait=wait, timeout=timeout
    )


class _Climb:
    """The climb to the altitude of a takeoff."""

    def __init__(self, vehicle: Vehicle, altitude: float, tolerance: float | None) -> None:
        self._vehicle, self._altitude = vehicle, altitude
        self._on_wing = vehicle.vehicle_type is VehicleType.PLANE
        # ArduPlane ends its climb some metres below the altitude, which it counts from the start
        # position, not from home.
        usual = max(3.0, altitude / 16) if self._on_wing else max(1.0, altitude / 20)
        self._near_limit, self._rest_limit = tolerance or TAKEOFF_TOLERANCE, tolerance or usual
        self._near = Settled(vehicle, TAKEOFF_SETTLING_TIME, TAKEOFF_SETTLING_SPAN)
        self._at_rest = Settled(vehicle, TAKEOFF_RESTING_TIME, TAKEOFF_SETTLING_SPAN)

    def remaining(self) -> float | None:
        """Return the metres to go; None if the height is not known."""
        height = relative_altitude_of(self._vehicle)
        if height is None:
            return None
        below = self._altitude - height
        return max(below, 0.0) if self._on_wing else abs(below)

    def reached(self) -> bool:
        """Return whether the vehicle has settled at the altitude; a wing: whether it is high enough."""
        rest, height = self.remaining(), relative_altitude_of(self._vehicle)
        # its altitude may be wrong: ArduPlane reports it above the sea until it knows home
        if self._vehicle.in_air is False:
            return False
        if self._on_wing or rest is None:
            return rest is not None and rest <= self._rest_limit
        settled = self._near.update(height if rest <= self._near_limit else None)
        return self._at_rest.update(height if rest <= self._rest_limit else None) or settled
