"""The cached state of a component is discarded when the component reboots, and no other state is."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.services.modes import ModeMonitor
from mavstack.services.parameters import ParameterClient
from mavstack.sim.virtual import run_virtually
from tests.node.vehicle import VehiclePair


@pytest.mark.parametrize("autopilot", [common.MavAutopilot.PX4, common.MavAutopilot.ARDUPILOTMEGA])
def test_cached_state_is_discarded_and_requested_again(autopilot):
    async def scenario():
        async with VehiclePair(autopilot=autopilot) as pair:
            remote = pair.remote
            assert remote.mission.progress is None
            remote._clients.get(ModeMonitor).custom_mode = 7
            remote._clients.get(ModeMonitor).intended = 7
            parameters = await remote.params.download()
            cameras = await remote.extended_params.download()
            pair.vehicle.send(common.MissionCurrent(seq=3, total=9))
            await asyncio.sleep(1)
            assert remote.mission.progress.seq == 3
            commands = []
            pair.vehicle.add_packet_listener(
                (common.CommandLong, common.CommandInt),
                lambda packet: commands.append(packet.message.command),
            )
            remote.clear_cache()
            assert not remote.params.cached
            assert not remote.extended_params.cached
            assert not remote._clients.get(ParameterClient).complete
            assert remote.modes.current is remote._clients.get(ModeMonitor).intended is None
            assert remote.mission.progress is None
            assert parameters
            assert cameras  # the mapping that the program has is unchanged
            assert (await remote.params.get("P_07")).value == 7
            asks_capabilities = autopilot == common.MavAutopilot.ARDUPILOTMEGA
            assert commands == [common.MavCmd.REQUEST_MESSAGE] * asks_capabilities

    run_virtually(scenario())


def test_clearing_an_empty_cache():
    async def scenario():
        async with VehiclePair() as pair:
            pair.remote.clear_cache()
            assert not pair.remote._clients.made

    run_virtually(scenario())


@pytest.mark.parametrize("part", ["params", "extended_params"])
def test_a_running_download_restarts(part):
    async def scenario():
        async with VehiclePair() as pair:
            params_part = getattr(pair.remote, part)
            lists = pair.vehicle.stream(common.ParamRequestList, common.ParamExtRequestList)
            fetching = asyncio.create_task(params_part.download())
            await anext(lists)
            pair.remote.clear_cache()
            fetched = await fetching
            assert len(lists.drain()) == 1
            assert len(fetched) == (40 if part == "params" else 1)

    run_virtually(scenario())
