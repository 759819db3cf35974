"""DO items that change the flight: speed, home, region of interest, fence, VTOL transition."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.behaviours.steps import transition
from mavstack.sim.autopilot.item_positions import has_place, place_of
from mavstack.sim.autopilot.mission.guided_limits import GuidedLimits
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.mission.rules import Step

_ROI = common.MavRoi
_SPEED = common.SpeedType
#: The value of the speed in DO_CHANGE_SPEED that restores the default speed.
_USUAL = -2.0
_SLOWEST = 0.1


def nothing(step: Step) -> Iterator[None]:
    """Do nothing: a mark, or a device that this vehicle does not have."""
    return
    yield


def change_speed(step: Step) -> Iterator[None]:
    """DO_CHANGE_SPEED: over ground or through the air (both alike), up, down."""
    yield from ()
    speed, maneuvers = step.number(2), step.maneuvers
    if not (speed > 0 or speed == _USUAL):
        return
    wanted = max(speed, _SLOWEST) if speed > 0 else None
    match step.whole(1):
        case _SPEED.CLIMB_SPEED:
            maneuvers.climb = wanted
        case _SPEED.DESCENT_SPEED:
            maneuvers.sink = wanted
        case _:
            maneuvers.speed = wanted


def set_home(step: Step) -> Iterator[None]:
    """DO_SET_HOME: param 1 = 1 sets the current position."""
    yield from ()
    autopilot = step.autopilot
    yaw = autopilot.body.estimate.yaw
    if step.whole(1) == 1 or not step.has_place:
        autopilot.set_home_here()
    else:
        autopilot.set_home(*autopilot.body.frame.to_global(*step.place(exact=True)), yaw=yaw)


def set_region(step: Step) -> Iterator[None]:
    """DO_SET_ROI, DO_SET_ROI_LOCATION: look at a position, at the next waypoint, or ahead."""
    yield from ()
    located = step.item.command == common.MavCmd.DO_SET_ROI_LOCATION
    mode = _ROI.LOCATION if located else step.whole(1)
    payload = step.autopilot.payload
    if mode == _ROI.WPNEXT:
        payload.region_of_interest = _next_place(step, step.seq + 1)
    elif mode == _ROI.WPINDEX:
        payload.region_of_interest = _next_place(step, step.whole(2))
    elif step.has_place:
        payload.region_of_interest = step.place(exact=True)
    else:
        payload.clear_region()


def _next_place(step: Step, seq: int) -> tuple[float, float, float] | None:
    """Return the position of the first item from `seq` on that has one."""
    items = step.mission.items
    places = (place_of(step.autopilot, item) for item in items[max(seq, 0) :] if _is_placed(step, item))
    return next(places, None)


def _is_placed(step: Step, item: MissionItem) -> bool:
    return has_place(item) and step.mission.rules.navigates(item)


def clear_region(step: Step) -> Iterator[None]:
    """DO_SET_ROI_NONE."""
    yield from ()
    step.autopilot.payload.clear_region()


def switch_fence(step: Step) -> Iterator[None]:
    """DO_FENCE_ENABLE."""
    yield from ()
    step.autopilot.fence.switch(step.whole(1))


def change_flight(step: Step) -> Iterator[None]:
    """DO_VTOL_TRANSITION: hover or fly forward, and wait for the transition."""
    forward = step.whole(1) == common.MavVtolState.FW
    if step.autopilot.vehicle.vehicle_type is not VehicleType.VTOL or step.autopilot.landed:
        return
    step.mission.hovers = not forward
    step.mission.course.clear()
    yield from transition(step.autopilot, forward=forward)


def limit_guided(step: Step) -> Iterator[None]:
    """DO_GUIDED_LIMITS."""
    yield from ()
    limits = (step.number(index) for index in range(1, 5))
    step.mission.guided_limits = GuidedLimits(*limits)


def arm_or_disarm(step: Step) -> Iterator[None]:
    """COMPONENT_ARM_DISARM: disarm on the ground."""
    yield from ()
    if step.whole(1) == 0 and step.autopilot.landed:
        step.mission.later(lambda: step.autopilot.disarm("mission item"))


def use_function(step: Step) -> Iterator[None]:
    """DO_AUX_FUNCTION: run the function of a switch, at a position of the switch."""
    yield from ()
    high, payload = step.whole(2) == 2, step.autopilot.payload
    function = step.whole(1)
    if function in _RELAYS:
        payload.set_relay(_RELAYS[function], on=high)
    match function:
        case 9 if high:
            payload.take_image()
        case 11:
            step.autopilot.fence.switch(int(high))
        case 19:
            payload.grip(closed=high)
        case 15:
            payload.sprayer = high
        case 22:
            payload.parachute_enabled = high


_RELAYS = {28: 0, 34: 1, 35: 2, 36: 3, 66: 4, 67: 5}
