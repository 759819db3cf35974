"""The content of a plan file: a mission, a fence, rally points, and the home they were planned from.

The file formats, the firmwares and the wire number the items of a mission in different ways, because some of
them count the home position as item 0 and some do not. Here it is never counted: `mission` holds the items to
fly, `home` is separate, and an item that names another one (DO_JUMP) holds its index in `mission`, from 0. So
a plan means the same whatever format it was read from:

    format                    item 0 is     the number of the first item to fly
    QGC .plan                 (none)        1, its `doJumpId`
    QGC WPL 110, 100          the home      1
    QGC WPL 120               (none)        0
    wire, ArduPilot           the home      1
    wire, PX4 and others      (none)        0

`mission_for` returns the mission as a vehicle counts it, `of_vehicle` converts it back; `home_first` means
that the vehicle's item 0 is its home. Fences and rally points are the same everywhere.

Frames with and without `_INT` mean the same (see `services.mission.item`); files get those without. A plan
without a home is uploaded to ArduPilot behind an empty item 0, which it replaces by its own home.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import isfinite
from struct import pack
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan, PlanType

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from typing import Self

CMD: Final = common.MavCmd
FRAME: Final = common.MavFrame

#: The name of each plan type in output and error texts.
PLAN_NAMES: Final[Mapping[int, str]] = MappingProxyType(
    {PlanType.MISSION: "mission", PlanType.FENCE: "fence", PlanType.RALLY: "rally points"}
)
_PLAIN_FRAMES: Final[Mapping[int, int]] = MappingProxyType(
    {
        FRAME.GLOBAL_INT: FRAME.GLOBAL,
        FRAME.GLOBAL_RELATIVE_ALT_INT: FRAME.GLOBAL_RELATIVE_ALT,
        FRAME.GLOBAL_TERRAIN_ALT_INT: FRAME.GLOBAL_TERRAIN_ALT,
    }
)


@dataclass(frozen=True, slots=True)
class Home:
    """A home position: degrees, and metres above mean sea level."""

    latitude: float
    longitude: float
    altitude: float = 0.0


@dataclass(frozen=True, slots=True)
class Settings:
    """The vehicle that a plan was made for; attributes that the file lacks are None.

    Attributes:
        firmware: The MAV_AUTOPILOT.
        vehicle_type: The MAV_TYPE.
        cruise_speed: Metres per second.
        hover_speed: Metres per second.
    """

    firmware: int | None = None
    vehicle_type: int | None = None
    cruise_speed: float | None = None
    hover_speed: float | None = None


@dataclass(frozen=True)
class PlanFile:
    """The plans of a file.

    Attributes:
        mission: The mission, without the home.
        fence: The fence.
        rally: The rally points.
        home: The home position that the mission was planned from.
        settings: The vehicle that the plans were made for.
        problems: The parts of the file that could not be read into the plans.
        notes: The assumptions that were made.
    """

    mission: Plan = field(default_factory=lambda: Plan(PlanType.MISSION))
    fence: Plan = field(default_factory=lambda: Plan(PlanType.FENCE))
    rally: Plan = field(default_factory=lambda: Plan(PlanType.RALLY))
    home: Home | None = None
    settings: Settings = field(default_factory=Settings, compare=False)
    problems: tuple[str, ...] = field(default=(), compare=False)
    notes: tuple[str, ...] = field(default=(), compare=False)

    @classmethod
    def of(
        cls,
        mission: Iterable[MissionItem] = (),
        fence: Iterable[MissionItem] = (),
        rally: Iterable[MissionItem] = (),
        home: Home | None = None,
    ) -> Self:
        """Return a plan file with these items."""
        return cls(
            Plan.of(mission, PlanType.MISSION),
            Plan.of(fence, PlanType.FENCE),
            Plan.of(rally, PlanType.RALLY),
            home,
        )

    @classmethod
    def of_vehicle(cls, plans: Iterable[Plan], *, home_first: bool, settings: Settings | None = None) -> Self:
        """Return a plan file with the plans that were downloaded from a vehicle."""
        held = {plan.type: tuple(map(_readable, plan.items)) for plan in plans}
        mission, home = held.get(PlanType.MISSION, ()), None
        if home_first:
            home = home_of(mission[0]) if mission else None
            mission = with_jumps_shifted(mission[1:], -1)
        whole = cls.of(mission, held.get(PlanType.FENCE, ()), held.get(PlanType.RALLY, ()), home)
        return replace(whole, settings=settings or Settings())

    def plan(self, kind: int) -> Plan:
        """Return the plan of a MAV_MISSION_TYPE."""
        return {PlanType.FENCE: self.fence, PlanType.RALLY: self.rally}.get(PlanType(kind), self.mission)

    def only(self, kinds: Iterable[int]) -> Self:
        """Return a copy with the plans of some types only; the home belongs to the mission."""
        wanted = set(kinds)
        return replace(
            self,
            mission=self.mission if PlanType.MISSION in wanted else Plan(PlanType.MISSION),
            fence=self.fence if PlanType.FENCE in wanted else Plan(PlanType.FENCE),
            rally=self.rally if PlanType.RALLY in wanted else Plan(PlanType.RALLY),
            home=self.home if PlanType.MISSION in wanted else None,
        )

    @property
    def kinds(self) -> tuple[PlanType, ...]:
        """The types of the plans that have items."""
        return tuple(PlanType(kind) for kind in PLAN_NAMES if len(self.plan(kind)))

    @property
    def first(self) -> int:
        """The number of the mission's first item: 1 after a home, otherwise 0."""
        return 0 if self.home is None else 1

    def for_vehicle(self, kind: int, *, home_first: bool) -> Plan:
        """Return a plan as a vehicle counts it."""
        return self.mission_for(home_first=home_first) if kind == PlanType.MISSION else self.plan(kind)

    def mission_for(self, *, home_first: bool) -> Plan:
        """Return the mission as a vehicle counts it."""
        if not home_first or not self.mission.items:
            return Plan.of(self.mission.items)
        return Plan.of((home_item(self.home), *with_jumps_shifted(self.mission.items, 1)))


def item_of(command: int, params: Sequence[float], frame: int, *, autocontinue: bool = True) -> MissionItem:
    """Return an item with seven params."""
    first, second, third, fourth, fifth, sixth, seventh = params
    return MissionItem(
        command,
        first,
        second,
        third,
        fourth,
        fifth,
        sixth,
        seventh,
        frame=plain_frame(frame),
        autocontinue=autocontinue,
    )


def params_of(item: MissionItem) -> tuple[float, ...]:
    """Return the seven params of an item."""
    return (item.param1, item.param2, item.param3, item.param4, item.param5, item.param6, item.param7)


def home_item(home: Home | None) -> MissionItem:
    """Return item 0 of a mission that begins with the home; an empty item if it is not known."""
    place = (0.0, 0.0, 0.0) if home is None else (home.latitude, home.longitude, home.altitude)
    return item_of(CMD.NAV_WAYPOINT, (0.0, 0.0, 0.0, 0.0, *place), FRAME.GLOBAL)


def home_of(item: MissionItem) -> Home | None:
    """Return the home in an item 0; None if the item is empty."""
    place = (item.param5, item.param6, item.param7)
    return None if not any(place) or not all(map(isfinite, place)) else Home(*place)


def with_jumps_shifted(items: Iterable[MissionItem], by: int) -> tuple[MissionItem, ...]:
    """Return the items with the targets of their jumps shifted."""
    return tuple(
        replace(item, param1=item.param1 + by) if item.command == CMD.DO_JUMP else item for item in items
    )


def plain_frame(frame: int) -> int:
    """Return the equivalent frame without `_INT`."""
    return int(_PLAIN_FRAMES.get(frame, frame))


def _readable(item: MissionItem) -> MissionItem:
    """Return a received item with the shortest numbers that are the same float32."""
    *first, latitude, longitude, altitude = params_of(item)
    params = (*map(_shortest, first), latitude, longitude, _shortest(altitude))
    return item_of(item.command, params, item.frame, autocontinue=item.autocontinue)


def _shortest(value: float) -> float:
    """Return the number with the fewest digits that is the same float32."""
    if not isfinite(value):
        return value
    wire = pack("<f", value)
    for digits in range(6, 9):
        short = float(f"{value:.{digits}g}")
        if pack("<f", short) == wire:
            return short
    return value
