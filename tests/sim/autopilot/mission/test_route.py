"""In which order items are flown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as some

from mavstack.sim.autopilot.mission.route import Route
from tests.sim.autopilot.mission.harness import CMD, item, waypoint

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem

WP = waypoint(10, 0)
HOME = WP


def route_of(*items: MissionItem, first: int = 1) -> Route:
    return Route(items, first, lambda item: item.command == CMD.NAV_WAYPOINT)


def flown(route: Route, limit: int = 50) -> list[int | None]:
    """The items that navigate, in the order in which they are flown."""
    order: list[int | None] = []
    leg = route.leg(route.first)
    while leg is not None and len(order) < limit:
        order.append(leg.navigation)
        leg = route.leg(leg.then)
    return order


def jump(target: float, repeats: float) -> MissionItem:
    return item(CMD.DO_JUMP, target, repeats)


def test_actions_belong_to_the_leg_of_the_next_item_that_navigates() -> None:
    servo = item(CMD.DO_SET_SERVO, 9, 1900)
    route = route_of(HOME, WP, servo, servo, WP, servo)
    legs = [route.leg(1), route.leg(2), route.leg(5)]
    assert [(leg.actions, leg.navigation) for leg in legs if leg] == [((), 1), ((2, 3), 4), ((5,), None)]
    assert route.leg(6) is None


def test_a_jump_is_taken_as_often_as_its_count() -> None:
    route = route_of(HOME, WP, WP, jump(1, 2), WP)
    assert flown(route) == [1, 2, 1, 2, 1, 2, 4]
    assert route.jumps_taken(3) == 2


def test_jumps_are_counted_anew_when_they_are_forgotten() -> None:
    route = route_of(HOME, WP, jump(1, 1), WP)
    assert flown(route) == [1, 1, 3]
    assert flown(route) == [1, 3]
    route.reset_jumps()
    assert flown(route) == [1, 1, 3]


def test_a_jump_without_end() -> None:
    assert flown(route_of(HOME, WP, WP, jump(2, -1)), limit=6) == [1, 2, 2, 2, 2, 2]


def test_a_jump_of_no_repeats_is_passed_over() -> None:
    assert flown(route_of(HOME, WP, jump(1, 0), WP)) == [1, 3]


def test_jumps_to_tags() -> None:
    tag = item(CMD.JUMP_TAG, 7)
    route = route_of(HOME, WP, tag, WP, item(CMD.DO_JUMP_TAG, 7, 1), WP)
    assert flown(route) == [1, 3, 3, 5]
    assert route.tagged(8) is None


def test_a_jump_to_nowhere_ends_the_mission() -> None:
    for target in (0.0, 9.0, -3.0, float("nan"), float("inf")):
        assert flown(route_of(HOME, WP, jump(target, 5), WP)) == [1]


def test_jumps_inside_jumps() -> None:
    route = route_of(HOME, WP, jump(1, 1), WP, jump(1, 1), WP)
    assert flown(route) == [1, 1, 3, 1, 3, 5]


def test_jumps_among_themselves_end() -> None:
    assert flown(route_of(HOME, jump(2, -1), jump(1, -1))) == []


def test_actions_without_end_end() -> None:
    route = route_of(HOME, item(CMD.DO_SET_SERVO), jump(1, -1))
    leg = route.leg(1)
    assert leg is not None
    assert leg.navigation is None
    assert route.leg(leg.then) is None


@pytest.mark.flight
@given(some.lists(some.sampled_from(["wp", "do", "jump", "tag", "jump to tag"]), max_size=12), some.data())
def test_any_route_is_walked(kinds: list[str], data: some.DataObject) -> None:
    number = some.floats(-3, 14) | some.just(float("nan")) | some.just(float("inf"))
    commands = {
        "wp": CMD.NAV_WAYPOINT,
        "do": CMD.DO_SET_RELAY,
        "jump": CMD.DO_JUMP,
        "tag": CMD.JUMP_TAG,
        "jump to tag": CMD.DO_JUMP_TAG,
    }
    items = [item(commands[kind], data.draw(number), data.draw(number)) for kind in kinds]
    for first in (0, 1):
        route = route_of(*items, first=first)
        for seq in flown(route, limit=40):
            assert seq is None or items[seq].command == CMD.NAV_WAYPOINT
