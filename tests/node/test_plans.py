"""The plans of a remote component."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.services.mission import MissionItem
from mavstack.sim.virtual import run_virtually
from tests.node.vehicle import VehiclePair

ITEMS = [MissionItem(common.MavCmd.NAV_WAYPOINT, param7=height) for height in (10.0, 20.0, 30.0)]


def test_set_current_falls_back_where_the_command_is_not_supported() -> None:
    async def work() -> None:
        async with VehiclePair() as pair:
            await pair.remote.mission.upload(ITEMS)
            await pair.remote.mission.set_current(2)
            assert pair.vehicle.mission.current == 2
            with pytest.raises(CommandDenied, match="UNSUPPORTED"):
                await pair.remote.mission.set_current(1, restart=True)  # only the command can restart

    run_virtually(work())


def test_set_current_falls_back_where_the_command_is_not_answered() -> None:
    async def work() -> None:
        async with VehiclePair() as pair:
            pair.vehicle._host.engine.remove(pair.vehicle.commands.server)
            await pair.remote.mission.upload(ITEMS)
            await pair.remote.mission.set_current(1)
            assert pair.vehicle.mission.current == 1

    run_virtually(work())


def test_set_current_does_not_fall_back_after_a_refusal() -> None:
    async def work() -> None:
        async with VehiclePair() as pair:
            pair.vehicle.mission.answer_commands(
                pair.vehicle.commands.server, pair.vehicle._host.engine.touch
            )
            await pair.remote.mission.upload(ITEMS)
            with pytest.raises(CommandDenied, match="DENIED"):
                await pair.remote.mission.set_current(3)
            await pair.remote.mission.set_current(2)
            assert pair.vehicle.mission.current == 2

    run_virtually(work())
