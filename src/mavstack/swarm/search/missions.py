"""Missions of a search: the legs of each vehicle as mission items, kept apart by height and by time.

Each vehicle climbs at its start to its own height, a layer above the one before, moves to its first leg,
searches, and returns. Vehicles that meet on the way are at different heights. Where the search itself needs
one height, as for pictures of one scale, `layer_spacing` is 0 and the vehicles start one after the other
(`start_delay`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.mission import MissionItem
from mavstack.swarm.search.areas import Track
from mavstack.swarm.search.detours import detour

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.geodesy import LocalFrame
    from mavstack.swarm.arrays import Points
    from mavstack.swarm.search.areas import Area, Corner


@dataclass(frozen=True, slots=True)
class MissionOptions:
    """How the legs become a mission.

    Attributes:
        altitude: Metres above home of the first vehicle.
        layer_spacing: Metres by which each further vehicle is higher.
        speed: Ground speed in m/s; None leaves it to the vehicle.
        start_delay: Seconds by which each further vehicle starts later.
        trigger_distance: Metres between pictures on the legs; 0: none are taken.
        take_off: True: the mission begins with a takeoff.
        return_home: True: the mission ends with a return to launch.
    """

    altitude: float = 30.0
    layer_spacing: float = 5.0
    speed: float | None = None
    start_delay: float = 0.0
    trigger_distance: float = 0.0
    take_off: bool = True
    return_home: bool = True

    def __post_init__(self) -> None:
        if not (math.isfinite(self.altitude) and self.altitude > 0.0):
            raise InvalidArgumentError(f"altitude must be finite and more than 0 m, got {self.altitude:g}")
        for name, value, unit in (
            ("layer_spacing", self.layer_spacing, "m"),
            ("start_delay", self.start_delay, "s"),
        ):
            if not (math.isfinite(value) and value >= 0.0):
                raise InvalidArgumentError(f"{name} must be finite and at least 0 {unit}, got {value:g}")


def search_mission(
    tracks: Sequence[Track],
    frame: LocalFrame,
    options: MissionOptions,
    *,
    index: int = 0,
    area: Area | None = None,
) -> list[MissionItem]:
    """Return the mission of one vehicle.

    Args:
        tracks: Its legs in order.
        frame: The frame of their metres north and east.
        options: Heights, speed and pictures.
        index: The number of the vehicle, from 0.
        area: The area, if ways between legs have to go around its obstacles.

    Returns:
        The items, as ordinary mission items for any vehicle and any plan file.
    """
    altitude = options.altitude + index * options.layer_spacing
    items = [MissionItem.takeoff(altitude)] if options.take_off else []
    if options.speed is not None:
        items.append(MissionItem.change_speed(options.speed))
    if options.start_delay and index:
        items.append(MissionItem.delay(index * options.start_delay))
    items += _legs(tracks, frame, altitude, options, area)
    if options.return_home:
        items.append(MissionItem.return_to_launch())
    return items


def path_mission(
    corners: Sequence[Corner] | Points, frame: LocalFrame, options: MissionOptions, *, index: int = 0
) -> list[MissionItem]:
    """Return the mission of a pattern that one vehicle flies from corner to corner.

    Args:
        corners: Metres north and east, in order.
        frame: The frame of the corners.
        options: Heights, speed and pictures.
        index: The number of the vehicle, from 0.
    """
    places = [(float(north), float(east)) for north, east in corners]
    legs = [Track(start, end, 0) for start, end in pairwise(places)]
    return search_mission(legs, frame, options, index=index)


def _legs(
    tracks: Sequence[Track], frame: LocalFrame, altitude: float, options: MissionOptions, area: Area | None
) -> Iterator[MissionItem]:
    here: Corner | None = None
    for track in tracks:
        if here is not None and area is not None:
            yield from (_waypoint(frame, place, altitude) for place in detour(area, here, track.start))
        if here != track.start:
            yield _waypoint(frame, track.start, altitude)
        if options.trigger_distance:
            yield _trigger(options.trigger_distance)
        yield _waypoint(frame, track.end, altitude)
        if options.trigger_distance:
            yield _trigger(0.0)
        here = track.end


def _waypoint(frame: LocalFrame, place: Corner, altitude: float) -> MissionItem:
    latitude, longitude, _ = frame.to_global(place[0], place[1], 0.0)
    # MISSION_ITEM_INT has seven decimal places of a degree.
    return MissionItem.waypoint(round(latitude, 7), round(longitude, 7), altitude)


def _trigger(distance: float) -> MissionItem:
    return MissionItem(common.MavCmd.DO_SET_CAM_TRIGG_DIST, param1=distance, param3=float(distance > 0.0))
