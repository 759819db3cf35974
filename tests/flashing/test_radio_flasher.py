"""SiK radios: the bootloader, the parameters, refusals; both ends of a pair."""

from __future__ import annotations

from random import Random

import pytest

from mavstack.flashing import (
    FlashingError,
    FlashingRefused,
    FlashOptions,
    bootloader_port,
    flash_firmware,
    parse_firmware,
)
from mavstack.flashing import radio_flasher as module
from mavstack.flashing.simulated_port import SimulatedPort
from mavstack.flashing.simulated_radio import SimulatedSikRadio
from mavstack.links import MemoryNetwork
from mavstack.radio.modem import SikModem
from mavstack.sim.virtual import run_virtually
from tests.flashing.test_intel_hex import line

CODE = Random(1).randbytes(3000)
NAME = "radio~hm_trp.ihx"


def firmware(name: str = NAME):
    lines = [line(0, 0x400 + start, CODE[start : start + 16]) for start in range(0, len(CODE), 16)]
    return parse_firmware("\n".join([*lines, line(1, 0)]).encode(), name)


@pytest.fixture
def run(monkeypatch):
    """Flash a simulated radio in virtual time."""

    def flash(radio, file, **options):
        network = MemoryNetwork()
        monkeypatch.setattr(bootloader_port, "open_link", lambda url: network.link())
        monkeypatch.setattr(module, "SikModem", lambda url: SikModem(network.link()))

        async def work():
            async with SimulatedPort(radio, network.link()):
                return await flash_firmware(file, "/dev/ttyUSB0", FlashOptions(**options))

        return run_virtually(work())

    return flash


def holds(radio) -> bool:
    return bytes(radio.flash[0x400 : 0x400 + len(CODE)]) == CODE


def test_a_running_radio(run) -> None:
    radio = SimulatedSikRadio()
    radio.pair.near.set(NETID=77)
    radio.on_erase = lambda: radio.pair.near.set(NETID=25, TXPOWER=1)
    result = run(radio, firmware())
    assert (result.board, result.written) == ("radio hm_trp, 915 MHz", 3000)
    assert result.notes == ("2 parameters of the radio restored.",)
    assert holds(radio)
    assert not radio.in_bootloader
    assert radio.pair.near.stored[3] == 77


def test_a_radio_in_its_bootloader(run) -> None:
    radio = SimulatedSikRadio(has_firmware=False)
    assert run(radio, firmware()).notes == ()
    assert holds(radio)
    assert not radio.in_bootloader


@pytest.mark.parametrize("name", ["radio~rfd900a.ihx", "radio~rfd900.ihx", "radio~rf50.ihx"])
def test_the_firmware_of_another_radio_is_refused(run, name) -> None:
    radio = SimulatedSikRadio()
    with pytest.raises(
        FlashingRefused, match="flashing radio hm_trp, 915 MHz failed: the firmware is for radio"
    ):
        run(radio, firmware(name))
    assert set(radio.flash) == {0xFF}
    assert not radio.in_bootloader  # its firmware runs again


def test_a_file_whose_name_has_no_board(run) -> None:
    radio = SimulatedSikRadio()
    with pytest.raises(FlashingRefused, match="'firmware' is not the name of a board; add --board"):
        run(radio, firmware("firmware.ihx"))
    assert radio.pair.near.boots == 0
    run(radio, firmware("firmware.ihx"), radio_board="HM-TRP")
    assert holds(radio)


def test_a_dry_run(run) -> None:
    radio = SimulatedSikRadio()
    assert run(radio, firmware(), dry_run=True).written == 0
    assert set(radio.flash) == {0xFF}
    assert not radio.in_bootloader


def test_flash_that_cannot_be_written(run) -> None:
    class Broken(SimulatedSikRadio):
        def _answer(self, kind, request):
            self.flash[0x500] = CODE[0x100] ^ 1
            return super()._answer(kind, request)

    with pytest.raises(FlashingError, match="verifying the radio failed near address 0x"):
        run(Broken(), firmware())
