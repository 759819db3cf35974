"""The driver against a simulated pair, in virtual time."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.errors import LinkError, RadioError
from mavstack.links import memory_pair
from mavstack.radio import AtCommand, Reply, SikModem, SikRadio, radio_url
from mavstack.sim.virtual import run_virtually
from tests.radio.pairs import bench


def test_commands_run_and_the_radio_passes_bytes_afterwards():
    async def main():
        async with bench() as table:
            await table.modem.enter()
            assert table.pair.near.in_command_mode
            assert await table.modem.run(AtCommand("ATI", Reply.LINE)) == ("SiK 2.2 on HM-TRP",)
            near = table.pair.near
        assert not near.in_command_mode

    run_virtually(main())


def test_a_cancelled_command_leaves_the_radio_passing_bytes():
    async def main():
        async with bench() as table:
            await table.modem.enter()
            table.pair.near.fails = lambda command: False
            table.pair.far.powered = False
            task = asyncio.create_task(table.modem.run(AtCommand("RTI", Reply.LINE)))
            await asyncio.sleep(0.5)
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            near = table.pair.near
        assert not near.in_command_mode

    run_virtually(main())


def test_bytes_end_the_guard_time_of_an_interrupted_escape():
    async def main():
        async with bench() as table:
            task = asyncio.create_task(table.modem.enter())
            await asyncio.sleep(1.5)  # +++ was sent; the radio waits for silence
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            await table.modem.leave()
            await asyncio.sleep(3)
            assert not table.pair.near.in_command_mode

    run_virtually(main())


def test_a_radio_that_was_left_in_command_mode_is_found():
    async def main():
        async with bench() as table:
            table.pair.near.in_command_mode = True
            assert await SikRadio(table.modem).get_value(3) == 25

    run_virtually(main())


def test_a_device_that_is_no_radio_is_reported():
    async def main():
        program, other = memory_pair()
        await other.open()
        async with SikModem(program) as modem:
            with pytest.raises(RadioError, match="no OK; check that the device is a SiK radio"):
                await modem.enter()
        await other.close()

    run_virtually(main())


def test_a_lost_link_ends_the_command():
    async def main():
        async with bench() as table:
            await table.modem.enter()
            task = asyncio.create_task(table.modem.run(AtCommand("RTI", Reply.LINE)))
            await asyncio.sleep(0)
            table.modem._channel.close("unplugged")
            with pytest.raises(RadioError, match="link was lost: unplugged"):
                await task

    run_virtually(main())


def test_a_link_without_a_peer_is_reported():
    async def main():
        program, _other = memory_pair()
        with pytest.raises(LinkError, match="nothing is connected"):
            await SikModem(program).open()

    run_virtually(main())


def test_urls_take_devices_and_rates():
    assert radio_url("/dev/ttyUSB0", 115200) == "serial:///dev/ttyUSB0?baud=115200"
    assert radio_url("/tmp/near") == "serial:///tmp/near"
    assert radio_url("tcpout://host:4001") == "tcpout://host:4001"
