"""The faces of a remote component's plans."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.services.mission import MissionItem
from mavstack.sim.virtual import run_virtually
from tests.node.vehicle import Pair

ITEMS = [MissionItem(common.MavCmd.NAV_WAYPOINT, param7=height) for height in (10.0, 20.0, 30.0)]


def test_the_current_item_is_set_the_older_way_where_the_newer_is_not_known() -> None:
    async def work() -> None:
        async with Pair() as pair:
            await pair.remote.mission.upload(ITEMS)
            await pair.remote.mission.set_current(2)
            assert pair.vehicle.mission.current == 2
            with pytest.raises(CommandDenied, match="UNSUPPORTED"):
                await pair.remote.mission.set_current(1, restart=True)  # only the newer can

    run_virtually(work())


def test_the_current_item_is_set_the_older_way_where_the_newer_stays_unanswered() -> None:
    async def work() -> None:
        async with Pair() as pair:
            pair.vehicle._host.engine.remove(pair.vehicle.commands.server)
            await pair.remote.mission.upload(ITEMS)
            await pair.remote.mission.set_current(1)
            assert pair.vehicle.mission.current == 1

    run_virtually(work())


def test_a_refusal_is_not_gone_round() -> None:
    async def work() -> None:
        async with Pair() as pair:
            pair.vehicle.mission.answer_commands(
                pair.vehicle.commands.server, pair.vehicle._host.engine.touch
            )
            await pair.remote.mission.upload(ITEMS)
            with pytest.raises(CommandDenied, match="DENIED"):
                await pair.remote.mission.set_current(3)
            await pair.remote.mission.set_current(2)
            assert pair.vehicle.mission.current == 2

    run_virtually(work())
