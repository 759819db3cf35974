"""The flight of one leg: its DO and CONDITION items, and the NAV item at its end.

ArduPilot runs the DO and CONDITION items of a leg beside its NAV item, PX4 before it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.sim.autopilot.mission.rules import Step
from mavstack.sim.autopilot.mission.scripts import script_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.mission.route import Leg
    from mavstack.sim.autopilot.mission.runner import MissionRunner

#: The default that `next` returns when a script has ended.
ENDED = object()


def fly_leg(host: MissionRunner, leg: Leg) -> Iterator[None]:
    """Run the items of a leg until the NAV item is complete or the mission is interrupted."""
    items = host.items
    actions = _act(host, leg)
    if not host.rules.actions_meanwhile:
        yield from host.until_interrupted(actions)
    if leg.navigation is None:
        yield from host.until_interrupted(actions)
        return
    navigation = _perform(host, leg.navigation, items[leg.navigation])
    yield from host.until_interrupted(_fly_with_actions(navigation, actions))


def _fly_with_actions(navigation: Iterator[None], actions: Iterator[None]) -> Iterator[None]:
    """Run the NAV item and the other items of its leg; the end of the NAV item ends all."""
    while True:
        next(actions, None)
        if next(navigation, ENDED) is ENDED:
            return
        yield


def _act(host: MissionRunner, leg: Leg) -> Iterator[None]:
    items = host.items
    for seq in leg.actions:
        yield from _perform(host, seq, items[seq])
        if host.rules.actions_meanwhile:
            yield


def _perform(host: MissionRunner, seq: int, item: MissionItem) -> Iterator[None]:
    step = Step(host, seq, item)
    if host.rules.navigates(item) or not host.rules.actions_meanwhile:
        host.set_current(seq)
        host.flown = item
    host.rules.started(step)
    yield from script_of(item.command)(step)
    if host.rules.reports(item):
        host.report_reached(seq)
