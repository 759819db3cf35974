"""What was remembered of a component that started anew is forgotten, and nothing else."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.sim.virtual import run_virtually
from tests.node.vehicle import Pair


@pytest.mark.parametrize("autopilot", [common.MavAutopilot.PX4, common.MavAutopilot.ARDUPILOTMEGA])
def test_what_it_told_is_forgotten_and_asked_for_again(autopilot):
    async def scenario():
        async with Pair(autopilot=autopilot) as pair:
            remote = pair.remote
            assert remote.mission.progress is None
            remote._clients.modes.custom_mode = 7
            remote._clients.modes.intended = 7
            parameters = await remote.params.download()
            cameras = await remote.extended_params.download()
            pair.vehicle.send(common.MissionCurrent(seq=3, total=9))
            await asyncio.sleep(1)
            assert remote.mission.progress.seq == 3
            asked = []
            pair.vehicle.add_packet_listener(
                (common.CommandLong, common.CommandInt), lambda packet: asked.append(packet.message.command)
            )
            remote.clear_cache()
            assert not remote.params.cached
            assert not remote.extended_params.cached
            assert not remote._clients.params.complete
            assert remote.modes.current is remote._clients.modes.intended is None
            assert remote.mission.progress is None
            assert parameters
            assert cameras  # who was given them keeps them
            assert (await remote.params.get("P_07")).value == 7
            assert asked == [common.MavCmd.REQUEST_MESSAGE]  # its capabilities

    run_virtually(scenario())


def test_there_may_be_nothing_to_forget():
    async def scenario():
        async with Pair() as pair:
            pair.remote.clear_cache()
            assert not {"params", "modes", "mission"} & set(vars(pair.remote._clients))

    run_virtually(scenario())


@pytest.mark.parametrize("face", ["params", "extended_params"])
def test_a_listing_under_way_begins_anew(face):
    async def scenario():
        async with Pair() as pair:
            asked_of = getattr(pair.remote, face)
            lists = pair.vehicle.stream(common.ParamRequestList, common.ParamExtRequestList)
            fetching = asyncio.create_task(asked_of.download())
            await anext(lists)
            pair.remote.clear_cache()
            fetched = await fetching
            assert len(lists.drain()) == 1
            assert len(fetched) == (40 if face == "params" else 1)

    run_virtually(scenario())
