"""New components are limited in rate for each channel, and a full table removes the least certain first."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.heartbeat.admission import (
    MAX_CHANNELS,
    MAX_NEW_BURST,
    MAX_NEW_RATE,
    MIN_HEARD_DURATION,
    REMOVED_AT_ONCE,
    NewComponentLimit,
    components_to_remove,
)
from mavstack.services.heartbeat.component_info import ComponentInfo


def admitted(limit: NewComponentLimit, channel: str, now: float, count: int = 1000) -> int:
    return sum(limit.admits(channel, now) for _ in range(count))


def test_a_burst_and_a_rate_are_admitted_for_each_channel() -> None:
    limit = NewComponentLimit()
    assert admitted(limit, "a", 0.0) == MAX_NEW_BURST
    assert admitted(limit, "b", 0.0) == MAX_NEW_BURST
    assert admitted(limit, "a", 0.5) == MAX_NEW_RATE / 2
    assert admitted(limit, "a", 0.4) == 0
    assert admitted(limit, "a", 1000.0) == MAX_NEW_BURST


def test_the_number_of_channels_is_bounded() -> None:
    limit = NewComponentLimit()
    for number in range(MAX_CHANNELS + 9):
        limit.admits(str(number), 0.0)
    assert len(limit._budgets) == MAX_CHANNELS


def component(number: int, *, first: float = 0.0, last: float = 0.0, alive: bool = True) -> ComponentInfo:
    quadrotor, px4 = common.MavType.QUADROTOR, common.MavAutopilot.PX4
    return ComponentInfo(Address(number, 1), quadrotor, px4, 0, 0, 0, first, last, alive=alive)


def test_unverified_new_and_lost_components_are_removed_first() -> None:
    verified = component(1)
    alive = component(2, last=MIN_HEARD_DURATION)
    lost = component(3, last=MIN_HEARD_DURATION, alive=False)
    late, early = component(4, first=2.0, last=2.0), component(5, first=1.0, last=1.0)
    table = [verified, alive, lost, late, early]
    order = components_to_remove(table, lambda address: address == verified.address)
    assert order == [early, late, lost, alive, verified]


def test_a_part_of_a_full_table_is_removed_at_once() -> None:
    table = [component(number % 250) for number in range(2 * REMOVED_AT_ONCE)]
    assert len(components_to_remove(table, lambda address: False)) == REMOVED_AT_ONCE
