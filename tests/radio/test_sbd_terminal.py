"""A simulated Iridium modem has a terminal, another name, and a mailbox that rings."""

from __future__ import annotations

import os
import sys

import pytest

from mavstack.radio.sbd_terminal import SbdTerminal

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pseudo terminals of POSIX")


async def test_a_ring_over_another_name(tmp_path):
    name = tmp_path / "modem"
    async with SbdTerminal() as terminal:
        terminal.link(name)
        descriptor = os.open(name, os.O_RDWR | os.O_NOCTTY)
        try:
            terminal.deliver(b"hello")
            assert os.read(descriptor, 100) == b"\r\nSBDRING\r\n"
            assert list(terminal.modem.mailbox) == [b"hello"]
        finally:
            os.close(descriptor)
    assert not name.is_symlink()
