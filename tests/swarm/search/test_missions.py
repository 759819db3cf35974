"""Searches as ordinary missions."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import LocalFrame
from mavstack.swarm.search.areas import Area, Track
from mavstack.swarm.search.missions import MissionOptions, path_mission, search_mission
from mavstack.swarm.search.patterns import sector

FRAME = LocalFrame(47.0, 8.0, 400.0)
CMD = common.MavCmd


def test_a_vehicle_takes_off_to_its_layer_searches_and_returns():
    tracks = [Track((0.0, 0.0), (100.0, 0.0), 0), Track((100.0, 20.0), (0.0, 20.0), 0)]
    options = MissionOptions(altitude=30, layer_spacing=5, speed=7, trigger_distance=12, start_delay=20)
    items = search_mission(tracks, FRAME, options, index=2)
    assert [item.command for item in items] == [
        CMD.NAV_TAKEOFF,
        CMD.DO_CHANGE_SPEED,
        CMD.NAV_DELAY,
        *[CMD.NAV_WAYPOINT, CMD.DO_SET_CAM_TRIGG_DIST, CMD.NAV_WAYPOINT, CMD.DO_SET_CAM_TRIGG_DIST] * 2,
        CMD.NAV_RETURN_TO_LAUNCH,
    ]
    assert {item.param7 for item in items if item.command == CMD.NAV_WAYPOINT} == {40.0}
    assert items[2].param1 == 40.0
    assert FRAME.to_local(items[5].param5, items[5].param6, 400.0) == pytest.approx(
        (100.0, 0.0, 0.0), abs=0.01
    )


def test_ways_between_legs_go_around_obstacles():
    area = Area([(0, 0), (100, 0), (100, 100), (0, 100)], [[(30, 10), (70, 10), (70, 90), (30, 90)]])
    tracks = [Track((10.0, 20.0), (10.0, 60.0), 0), Track((90.0, 60.0), (90.0, 20.0), 1)]
    options = MissionOptions(take_off=False, return_home=False)
    direct = search_mission(tracks, FRAME, options)
    around = search_mission(tracks, FRAME, options, area=area)
    assert len(direct) == 4
    assert [FRAME.to_local(item.param5, item.param6, 400.0)[:2] for item in around[2:4]] == [
        pytest.approx(corner, abs=0.01) for corner in ((30.0, 90.0), (70.0, 90.0))
    ]


def test_a_pattern_is_flown_from_corner_to_corner():
    items = path_mission(sector(100.0), FRAME, MissionOptions())
    assert [item.command for item in items] == [
        CMD.NAV_TAKEOFF,
        *[CMD.NAV_WAYPOINT] * 10,
        CMD.NAV_RETURN_TO_LAUNCH,
    ]


def test_an_altitude_is_above_ground():
    with pytest.raises(InvalidArgumentError, match="altitude must be finite and more than 0 m"):
        MissionOptions(altitude=0.0)
