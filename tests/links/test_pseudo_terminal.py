from __future__ import annotations

import asyncio
import os
import sys
from contextlib import asynccontextmanager

import pytest

from mavstack.errors import LinkError
from mavstack.links import open_link

from .conformance import Conformance, receive

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs ptys")


class ProgramAtTheTerminal:
    """A program that has opened the terminal like a serial port."""

    def __init__(self, path) -> None:
        self._file = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)

    async def send(self, data: bytes) -> None:
        while data:
            try:
                data = data[os.write(self._file, data) :]
            except BlockingIOError:
                await asyncio.sleep(0.001)

    async def receive(self, size: int) -> bytes:
        received = b""
        while len(received) < size:
            try:
                received += os.read(self._file, size - len(received))
            except BlockingIOError:
                await asyncio.sleep(0.001)
        return received

    async def close(self) -> None:
        os.close(self._file)


class TestPseudoTerminal(Conformance):
    detects_disconnect = False

    @pytest.fixture(autouse=True)
    def _path(self, tmp_path):
        self.path = tmp_path / "ttyDrone"

    @asynccontextmanager
    async def pair(self, query=""):
        async def open_peer():
            return ProgramAtTheTerminal(self.path)

        yield open_link(f"pty://{self.path}?{query}"), open_peer


async def test_programs_come_and_go_and_the_path_goes_with_the_link(tmp_path):
    path = tmp_path / "ttyDrone"
    async with open_link(f"pty://{path}") as link:
        channel = (await anext(link)).channel
        for _ in range(2):
            program = ProgramAtTheTerminal(path)
            await program.send(b"\x03\x11\r\n")
            assert await receive(link, 4) == b"\x03\x11\r\n"
            channel.write(b"\n\x04")
            assert await program.receive(2) == b"\n\x04"
            await program.close()
    assert not path.is_symlink()


async def test_a_path_that_exists_is_refused_unless_a_killed_program_left_it(tmp_path):
    path = tmp_path / "file"
    path.write_text("keep")
    with pytest.raises(LinkError, match="cannot open pty://"):
        await open_link(f"pty://{path}").open()
    assert path.read_text() == "keep"
    path.unlink()
    path.symlink_to("/dev/pts/99999")
    async with open_link(f"pty://{path}"):
        assert str(path.readlink()) != "/dev/pts/99999"
