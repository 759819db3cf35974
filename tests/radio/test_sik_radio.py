"""Identity, parameters and reports of radios, near and far."""

from __future__ import annotations

from contextlib import aclosing

import pytest

from mavstack.errors import InvalidArgumentError, InvalidStateError, RadioError
from mavstack.radio import PARAMETERS, RadioIdentity, SikRadio
from mavstack.radio.sik_radio import check_values, require_known
from mavstack.radio.simulator import DEFAULTS
from mavstack.sim.virtual import run_virtually
from tests.radio.pairs import bench


@pytest.mark.parametrize("remote", [False, True])
def test_identity_parameters_and_signal(remote):
    async def main():
        async with bench() as table:
            radio = SikRadio(table.modem, remote=remote)
            assert await radio.get_identity() == RadioIdentity("SiK 2.2 on HM-TRP", 77, 915, 1)
            found = (
                await radio.get_parameters()
            )  # the remote list is cut to one packet: the rest is asked for
            assert list(found) == list(PARAMETERS)
            assert tuple(each.value for each in found.values()) == DEFAULTS
            assert (await radio.get_rssi()).local_rssi == 180
            await radio.set_value(4, 11)
            await radio.store()
            target = table.pair.far if remote else table.pair.near
            assert target.stored[4] == 11
            await radio.reset()
            assert target.values[4] == 20
            await radio.restart()
            assert target.boots == 1

    run_virtually(main())


def test_reports_come_by_themselves_and_end_with_the_iterator():
    async def main():
        async with bench() as table:
            near = SikRadio(table.modem)
            table.pair.near.reports = True  # another program left them on: the command would turn them off
            async with aclosing(near.stream_rssi()) as reports:
                found = [report.local_noise async for report in first_of(reports, 3)]
                assert table.pair.near.reports
                assert await near.get_value(3) == 25  # a report is no reply
            assert (found, table.pair.near.reports) == ([50, 50, 50], False)
            with pytest.raises(InvalidStateError, match="its own serial port"):
                await anext(SikRadio(table.modem, remote=True).stream_rssi())

    run_virtually(main())


def test_a_radio_that_prints_no_reports_is_asked_for_them():
    async def main():
        async with bench() as table:
            table.pair.near.fails = lambda command: command.startswith("AT&T")
            async with aclosing(SikRadio(table.modem).stream_rssi()) as reports:
                assert (await anext(reports)).local_rssi == 180

    run_virtually(main())


async def first_of(source, count):
    for _ in range(count):
        yield await anext(source)


def test_replies_that_are_lost_are_asked_for_again():
    async def main():
        async with bench() as table:
            await table.modem.enter()
            losses = iter([True, False, False, True])
            table.pair.loses = lambda: next(losses, False)
            radio = SikRadio(table.modem, remote=True)
            assert await radio.get_value(3) == 25
            assert await radio.get_value(2) == 64

    run_virtually(main())


def test_a_silent_remote_radio_is_reported():
    async def main():
        async with bench() as table:
            table.pair.far.powered = False
            with pytest.raises(
                RadioError, match="RTI failed after 3 attempts: no answer: the remote radio is off"
            ):
                await SikRadio(table.modem, remote=True).get_identity()

    run_virtually(main())


def test_refusals_are_errors():
    async def main():
        async with bench() as table:
            radio = SikRadio(table.modem)
            with pytest.raises(RadioError, match="ATS15=200 failed: the radio answers ERROR") as caught:
                await radio.set_value(15, 200)
            assert caught.value.refused
            with pytest.raises(RadioError):
                await radio.get_value(99)
            with pytest.raises(InvalidArgumentError):
                await radio.set_value(3, -1)
            require_known(["NETID"], await radio.get_parameters(), radio)
            with pytest.raises(InvalidArgumentError, match="did you mean NETID"):
                require_known(["NETIT"], await radio.get_parameters(), radio)

    run_virtually(main())


def test_values_are_checked_before_anything_is_sent():
    with pytest.raises(InvalidArgumentError, match="ECC cannot be 2: the values are 0 to 1"):
        check_values({"NETID": 5, "ECC": 2})


def test_reports_between_replies_are_passed_over():
    async def main():
        async with bench() as table:
            radio = SikRadio(table.modem)
            await table.modem.enter()
            table.pair.near.reports = True
            assert await radio.get_value(3) == 25
            assert await radio.get_value(3) == 25

    run_virtually(main())


@pytest.mark.parametrize("remote", [False, True])
def test_the_timing_and_the_values_of_the_factory(remote):
    async def main():
        async with bench() as table:
            radio = SikRadio(table.modem, remote=remote)
            target = table.pair.far if remote else table.pair.near
            target.set(TXPOWER=11)
            target.values[4] = 12  # set, and not stored
            timing = {"silence_period": 65, "tx_window_width": 469, "max_data_packet_length": 156}
            assert await radio.get_timing() == timing
            values = await radio.get_factory_values()
            assert (values["TXPOWER"], values["NETID"], "FORMAT" in values) == (20, 25, False)
            assert (target.values[4], target.stored[4]) == (12, 11)
            target.fails = lambda command: command == "ATI6"
            assert await radio.get_timing() == {}

    run_virtually(main())
