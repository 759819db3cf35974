"""A simulated pair on real terminals, which programs open like serial ports."""

from __future__ import annotations

import asyncio
import os
import sys

import pytest

from mavstack.errors import LinkError
from mavstack.radio import RadioTerminals, SikModem, SikRadio, change_one

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo terminals")


@pytest.mark.flight  # the guard times are real seconds
async def test_both_radios_answer_over_serial_ports(tmp_path):
    async with RadioTerminals() as terminals:
        terminals.link(0, tmp_path / "near")
        async with SikModem(f"serial://{tmp_path / 'near'}") as modem:
            assert (await SikRadio(modem).get_parameters())["NETID"].value == 25
            assert await SikRadio(modem, remote=True).get_value(3) == 25
            await change_one(SikRadio(modem), {"SERIAL_SPEED": 115})  # opens the port again
            assert modem.url.options["baud"] == "115200"
        assert terminals.pair.near.stored[1] == 115
        assert not terminals.pair.near.in_command_mode
    assert not (tmp_path / "near").is_symlink()


async def test_bytes_pass_through_the_pair(tmp_path):
    async with RadioTerminals() as terminals:
        with pytest.raises(FileExistsError, match=str(tmp_path)):
            terminals.link(0, tmp_path)
        near, far = (os.open(device, os.O_RDWR | os.O_NOCTTY) for device in terminals.devices)
        os.set_blocking(far, False)
        os.write(near, b"hello")
        async with asyncio.timeout(20):
            data = b""
            while len(data) < 5:
                await asyncio.sleep(0.005)
                try:
                    data += os.read(far, 10)
                except BlockingIOError:
                    continue
        os.close(near)
        os.close(far)
    assert data == b"hello"


async def test_a_system_without_terminals_is_reported(monkeypatch):
    monkeypatch.setitem(sys.modules, "tty", None)
    with pytest.raises(LinkError, match="pseudo terminals"):
        async with RadioTerminals():
            pass
