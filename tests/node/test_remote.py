"""Each face of a remote component, once, against a component that offers everything."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import ParameterDenied
from mavstack.services import Address
from mavstack.services.manual_control import ManualInput
from mavstack.services.setpoints import LocalSetpoint
from tests.links.virtual import run_virtually
from tests.node.vehicle import Pair


def with_pair(work, **options) -> None:
    async def run() -> None:
        async with Pair(**options) as pair:
            await work(pair)

    run_virtually(run())


def test_parameters() -> None:
    async def work(pair: Pair) -> None:
        parameters = pair.remote.parameters
        assert (await parameters.get("P_07")).value == 7
        async with parameters.changes() as changes:
            assert (await parameters.set("P_07", 70)).value == 70
            assert (await anext(changes)).parameter.name == "P_07"
        steps: list = []
        fetched = await parameters.fetch(progress=lambda *step: steps.append(step))
        assert {name: parameter.value for name, parameter in fetched.items()} == {
            f"P_{number:02}": 70 if number == 7 else number for number in range(40)
        }
        assert steps[-1][1] == 40
        assert pair.vehicle.parameters["P_07"] == 70
        with pytest.raises(ParameterDenied, match="parameter NOPE asked of 1/1: DOES_NOT_EXIST"):
            await parameters.get("NOPE")

    with_pair(work)


def test_logs() -> None:
    async def work(pair: Pair) -> None:
        listed = await pair.remote.logs.list()
        assert [entry.size for entry in listed] == [10240, 5]
        assert await pair.remote.logs.download(listed[0]) == pair.vehicle.logs.contents[1]
        assert await pair.remote.logs.download(2) == b"short"
        await pair.remote.logs.erase()
        assert pair.vehicle.logs.contents == {}

    with_pair(work)


@pytest.mark.parametrize(
    ("autopilot", "mode", "name"),
    [
        (common.MavAutopilot.PX4, "return", "RTL"),
        (common.MavAutopilot.ARDUPILOTMEGA, "guided", "GUIDED"),
    ],
)
def test_modes(autopilot: int, mode: str, name: str) -> None:
    async def work(pair: Pair) -> None:
        modes = pair.remote.modes
        async with modes.changes() as changes:
            await modes.set(mode)
            assert modes.current.upper() == name
            assert changes.take()[-1].name.upper() == name
        assert len(await modes.list()) == 3

    with_pair(work, autopilot=autopilot)


def test_a_shell() -> None:
    async def work(pair: Pair) -> None:
        async with pair.remote.shell() as shell:
            shell.write_line("ver all")
            heard = ""
            while "ver all" not in heard:
                heard += await anext(shell)
            assert pair.vehicle.shell.owner == pair.ground.address
        await asyncio.sleep(1)
        assert pair.vehicle.shell.owner is None

    with_pair(work)


def test_setpoints_and_sticks_last_as_long_as_their_block() -> None:
    async def work(pair: Pair) -> None:
        ground = pair.ground.address
        async with pair.remote.setpoints(rate=10) as stream:
            stream.set(LocalSetpoint(velocity=(1.0, 0.0, -0.5)))
            await asyncio.sleep(1)
            setpoint, age = pair.vehicle.setpoints.latest(ground, pair.vehicle.now())
            assert setpoint.velocity == (1.0, 0.0, -0.5)
            assert age <= 0.1
        async with pair.remote.manual_control() as sticks:
            sticks.set(ManualInput(x=500))
            await asyncio.sleep(0.5)
            held, _ = pair.vehicle.sticks.latest(ground, pair.vehicle.now())
            assert held.x == 500
        async with pair.vehicle.packets(system=ground.system) as heard:
            await asyncio.sleep(3)
            assert {packet.name for packet in heard.take()} == {"HEARTBEAT"}
        assert len(pair.ground.engine._services) < 12

    with_pair(work)


def test_a_message_is_addressed_by_the_way() -> None:
    async def work(pair: Pair) -> None:
        async with pair.vehicle.messages(common.PlayTuneV2) as heard:
            pair.remote.send(common.PlayTuneV2(tune="MFT200"))
            message = await anext(heard)
        assert Address(message.target_system, message.target_component) == (1, 1)

    with_pair(work)
