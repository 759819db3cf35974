"""Changes of both ends: the radios talk again afterwards, or the error says what to do."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError, RadioError
from mavstack.radio import SikRadio, change_both, change_one, shared_differences
from mavstack.radio.pair import talks
from mavstack.radio.simulator import NAMES
from mavstack.sim.virtual import run_virtually
from tests.radio.pairs import bench

NEW = {"NETID": 42, "AIR_SPEED": 96}
NETID = NAMES.index("NETID")


def values(radio):
    return {name: radio.stored[NAMES.index(name)] for name in NEW}


def test_both_ends_change_and_talk_again():
    async def main():
        async with bench() as table:
            steps = []
            mine, theirs = await change_both(table.modem, NEW, NEW, steps.append)
            assert mine.values == theirs.values == NEW
            assert values(table.pair.near) == values(table.pair.far) == NEW
            assert table.pair.near.running == table.pair.far.running
            assert "waiting until they talk again" in steps
            boots = table.pair.near.boots
            await change_both(table.modem, NEW, NEW)
            assert table.pair.near.boots == boots  # nothing to change: no restart

    run_virtually(main())


def test_a_silent_remote_radio_changes_nothing():
    async def main():
        async with bench() as table:
            table.pair.far.powered = False
            with pytest.raises(RadioError, match="nothing was changed"):
                await change_both(table.modem, NEW, NEW)
            assert table.pair.near.values[NETID] == 25

    run_virtually(main())


@pytest.mark.parametrize("command", ["ATS2=96", "AT&W"])
def test_a_failed_write_of_the_remote_radio_leaves_both(command):
    async def main():
        async with bench() as table:
            table.pair.far.fails = lambda text: text == command
            with pytest.raises(
                RadioError, match=r"writing the remote radio failed.*local radio was not changed"
            ):
                await change_both(table.modem, NEW, NEW)
            assert table.pair.far.values[NETID] == table.pair.far.stored[NETID] == 25
            assert table.pair.near.values[NETID] == 25

    run_virtually(main())


def test_a_failed_write_of_the_local_radio_restores_the_remote_one():
    async def main():
        async with bench() as table:
            table.pair.near.fails = lambda text: text == "AT&W"
            with pytest.raises(RadioError, match="remote radio has its old parameters again"):
                await change_both(table.modem, NEW, NEW)
            assert table.pair.far.stored[NETID] == table.pair.near.stored[NETID] == 25

    run_virtually(main())


def test_a_remote_radio_that_does_not_restart_is_found_and_restored():
    async def main():
        async with bench() as table:
            table.pair.far.fails = lambda text: text == "ATZ"
            with pytest.raises(RadioError, match="both have their old parameters again"):
                await change_both(table.modem, NEW, NEW)
            assert table.pair.far.stored[NETID] == table.pair.near.running[NETID] == 25
            assert await talks(SikRadio(table.modem, remote=True), 1)

    run_virtually(main())


def test_a_remote_radio_that_is_lost_is_reported_with_the_remedy():
    async def main():
        async with bench() as table:
            far = table.pair.far
            far.fails = lambda text: text == "ATZ" and setattr(far, "powered", False) is None
            with pytest.raises(
                RadioError, match=r"switch the remote radio off and on.*set NETID=42, AIR_SPEED=96"
            ):
                await change_both(table.modem, NEW, NEW)
            assert table.pair.near.running[NETID] == 42
            far.fails = lambda text: False
            far.powered = True
            far.reboot(0)  # the remedy
            assert await talks(SikRadio(table.modem, remote=True))

    run_virtually(main())


def test_changes_survive_lost_packets():
    async def main():
        async with bench() as table:
            packets = iter(range(10**6))
            table.pair.loses = lambda: next(packets) % 4 == 3
            await change_both(table.modem, NEW, NEW)
            assert values(table.pair.near) == values(table.pair.far) == NEW

    run_virtually(main())


def test_a_restart_that_would_separate_the_radios_is_refused():
    async def main():
        async with bench() as table:
            far = table.pair.far
            far.values[NETID] = far.stored[NETID] = 7  # it still runs with 25
            with pytest.raises(InvalidArgumentError, match="they differ in NETID; set these"):
                await change_both(table.modem, {"TXPOWER": 11}, {"TXPOWER": 11})
            assert not table.pair.near.boots
            both = {"TXPOWER": 11, "NETID": 7}
            await change_both(table.modem, both, both)
            assert table.pair.near.running[NETID] == 7

    run_virtually(main())


def test_one_radio_changes_alone():
    async def main():
        async with bench() as table:
            change = await change_one(SikRadio(table.modem), {"TXPOWER": 11, "NETID": 25})
            assert change.values == {"TXPOWER": 11}
            assert table.pair.near.running[4] == 11
            await change_one(SikRadio(table.modem, remote=True), {"TXPOWER": 8})
            assert table.pair.far.stored[4] == 8
            with pytest.raises(InvalidArgumentError, match="no parameter SPEED"):
                await change_one(SikRadio(table.modem), {"SPEED": 1})

    run_virtually(main())


def test_differences_of_shared_parameters():
    async def main():
        async with bench() as table:
            near = await SikRadio(table.modem).get_parameters()
            far = {
                **near,
                "NETID": near["NETID"]._replace(value=7),
                "TXPOWER": near["TXPOWER"]._replace(value=1),
            }
            assert shared_differences(near, far) == {"NETID": (25, 7)}

    run_virtually(main())
