"""The missions of whole flights: the uploaded items, and the expected flight.

A `FlightPlan` holds the items, their positions in metres around home, and the order in which the NAV items
are reached: a jump flies the middle of each mission three times.

    home ── take-off ── A (waits) ── B (another speed) ── C ─┐ twice back to A
                                                            └── D ── circles, waits ── home
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import nan

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from mavstack.sim.motion import LocalFrame
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType

CMD, FRAME = common.MavCmd, common.MavFrame
Place = tuple[float, float, float]
_COPTER, _PLANE, _VTOL = VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL
_SUB = VehicleType.SUB
ROUNDS = 3


@dataclass(frozen=True)
class Size:
    """Distances and altitudes of a type's mission, its second speed, and its circle."""

    side: float
    height: float
    speed: float
    radius: float


SIZES = {
    VehicleType.COPTER: Size(30, 20, 4, 10),
    VehicleType.PLANE: Size(160, 30, 16, 60),
    VehicleType.VTOL: Size(170, 30, 18, 80),
    VehicleType.ROVER: Size(14, 0, 2.5, 5),
    VehicleType.BOAT: Size(14, 0, 1.5, 6),
    VehicleType.SUB: Size(7, -6, 0.7, 3),
}


@dataclass
class FlightPlan:
    """A mission under construction."""

    kind: VehicleType
    firmware: Firmware
    home: Home = DEFAULT_HOME
    items: list[MissionItem] = field(default_factory=list)
    #: Local positions of items with a position, by sequence number.
    places: dict[int, Place] = field(default_factory=dict)
    #: Circles around these positions.
    circles: dict[int, float] = field(default_factory=dict)
    #: The NAV items in the order in which they are reached.
    order: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.ardupilot:
            self._place(CMD.NAV_WAYPOINT, (0.0, 0.0, 0.0))  # home, which is not flown

    @property
    def ardupilot(self) -> bool:
        return self.firmware is Firmware.ARDUPILOT

    @property
    def size(self) -> Size:
        return SIZES[self.kind]

    def _place(self, command: int, place: Place, *params: float) -> int:
        latitude, longitude, _ = LocalFrame(*self.home[:3]).to_global(*place)
        numbers = (*params, 0.0, 0.0, 0.0, 0.0)[:4]
        self.items.append(MissionItem(int(command), *numbers, latitude, longitude, place[2]))  # type: ignore[call-arg]
        return len(self.items) - 1

    def go(self, command: int, place: Place, *params: float, circle: float = 0.0) -> int:
        """Add a NAV item with a position."""
        seq = self._place(command, place, *params)
        self.places[seq] = place
        if circle:
            self.circles[seq] = circle
        self.order.append(seq)
        return seq

    def go_without_position(self, command: int, *params: float) -> int:
        """Add a NAV item without a position."""
        seq = self.do(command, *params)
        self.order.append(seq)
        return seq

    def do(self, command: int, *params: float) -> int:
        """Add a DO item without a position."""
        self.items.append(MissionItem(int(command), *params, frame=FRAME.MISSION))
        return len(self.items) - 1

    def look_at(self, place: Place) -> int:
        return self._place(CMD.DO_SET_ROI_LOCATION, place)

    def jump_back(self, seq: int) -> None:
        """Jump from an item to here twice."""
        self.do(CMD.DO_JUMP, seq, ROUNDS - 1)
        repeated = [each for each in self.order if each >= seq]
        self.order += repeated * (ROUNDS - 1)


def whole_mission(kind: VehicleType, firmware: Firmware) -> FlightPlan:
    """Return a mission with every kind of item, for one type and firmware."""
    plan = FlightPlan(kind, firmware)
    side, height = plan.size.side, plan.size.height
    _take_off(plan)
    first = plan.go(CMD.NAV_WAYPOINT, (side, 0, height), 0 if kind in (_PLANE, _VTOL) else 2)
    plan.do(CMD.DO_CHANGE_SPEED, 0 if kind is _PLANE else 1, plan.size.speed, -1)
    plan.go(CMD.NAV_WAYPOINT, (side, side, height), 0, 0, 0, nan)
    _set_yaw(plan)
    plan.go(CMD.NAV_WAYPOINT, (0, side, height), 0, 0, 0, 90 if kind is _COPTER else nan)
    plan.jump_back(first)
    _use_payload(plan)
    plan.go(CMD.NAV_WAYPOINT, (-side / 2, side, height), 0, 0, 0, nan)
    plan.do(CMD.DO_SET_ROI_NONE)
    _loiter(plan)
    _return_home(plan)
    return plan


def triangle(kind: VehicleType, firmware: Firmware) -> FlightPlan:
    """Return a short mission: out and back in two legs."""
    plan = FlightPlan(kind, firmware)
    side, height = plan.size.side, plan.size.height
    _take_off(plan)
    plan.go(CMD.NAV_WAYPOINT, (side, 0, height))
    plan.go(CMD.NAV_WAYPOINT, (side / 2, side, height), 0, 0, 0, nan)
    _return_home(plan)
    return plan


def _take_off(plan: FlightPlan) -> None:
    if not plan.kind.flies:
        return
    command = CMD.NAV_VTOL_TAKEOFF if plan.kind is _VTOL else CMD.NAV_TAKEOFF
    at = (plan.size.side / 3, 0.0) if plan.kind is not _COPTER else (0.0, 0.0)
    height = plan.size.height / 2 if plan.kind is _PLANE else plan.size.height  # a wing climbs on its way
    plan.go(command, (*at, height), 0, 0, 0, nan)
    if plan.ardupilot or plan.kind is _COPTER:  # the take-offs of other types end at different positions
        plan.places[plan.order[-1]] = (0.0, 0.0, height)


def _set_yaw(plan: FlightPlan) -> None:
    if plan.ardupilot and plan.kind in (_COPTER, _SUB):
        plan.do(CMD.CONDITION_YAW, 180, 0, 1, 0)


def _use_payload(plan: FlightPlan) -> None:
    plan.look_at((0.0, 0.0, 0.0))
    if plan.ardupilot:
        plan.do(CMD.DO_SET_SERVO, 9, 1700)
    else:
        plan.do(CMD.DO_SET_ACTUATOR, 0.4, nan, nan, nan, nan, nan)
    plan.do(CMD.DO_GRIPPER, 1, common.GripperActions.RELEASE)


def _loiter(plan: FlightPlan) -> None:
    side, height, radius = plan.size.side, plan.size.height, plan.size.radius
    around = (-side / 2, 0.0, height)
    if plan.ardupilot:
        plan.go(CMD.NAV_LOITER_TURNS, around, 1, 0, radius, circle=radius)
    circles = radius if plan.kind in (_PLANE, _VTOL) else 0.0
    plan.go(CMD.NAV_LOITER_TIME, around, 6, 0, radius, nan if not plan.ardupilot else 0, circle=circles)
    if plan.kind not in (_PLANE, _VTOL):
        plan.go_without_position(CMD.NAV_DELAY, 3, *((-1, -1, -1) if plan.ardupilot else ()))


def _return_home(plan: FlightPlan) -> None:
    match plan.kind:
        case VehicleType.PLANE:
            plan.do(CMD.DO_LAND_START)
            plan.go(CMD.NAV_WAYPOINT, (-260.0, 0.0, plan.size.height), 0, 0, 0, nan)
            plan.go(CMD.NAV_LAND, (0.0, 0.0, 0.0), 0, 0, 0, 0)
        case VehicleType.VTOL:
            plan.go(CMD.NAV_VTOL_LAND, (0.0, 0.0, 0.0), 0, 0, 0, nan)
        case _:
            plan.go_without_position(CMD.NAV_RETURN_TO_LAUNCH)
