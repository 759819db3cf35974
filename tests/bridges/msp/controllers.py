"""A small flight controller on a memory link: fixed replies, a CLI and a pass-through, in virtual time."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.bridges.msp import FlightController
from mavstack.links import impair, memory_pair
from mavstack.links.events import BytesReceived, ChannelOpened
from mavstack.msp import Direction, Frame, FrameParser

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Sequence

    from mavstack.links import Channel, Impairment, Link, LinkEvent

IDENTITY = {
    1: b"\x00\x01\x2e",
    2: b"BTFL",
    3: b"\x04\x05\x01",
    4: b"S405\x00\x00\x02\x37\x09STM32F405\x00\x00",
    5: b"Nov 22 202621:10:03abc1234",
    10: b"quad",
    160: bytes(range(12)),
}
REBOOT_TIME = 2.0


@dataclass
class Firmware:
    """A firmware: the replies to commands, and the state of its line."""

    replies: dict[int, bytes | Callable[[bytes], bytes | None]] = field(default_factory=lambda: {**IDENTITY})
    settings: dict[str, str] = field(default_factory=lambda: {"gyro_hardware": "AUTO"})
    delay: float = 0.001
    received: list[Frame] = field(default_factory=list)
    raw: bytes = b""
    mode: str = "msp"
    restarts: int = 0
    silent: bool = False
    saved: dict[str, str] = field(default_factory=dict)
    parser: FrameParser = field(default_factory=FrameParser)
    line: bytes = b""
    failed: bool = False

    def __post_init__(self) -> None:
        self.saved = dict(self.settings)

    def receive(self, data: bytes, write: Callable[[bytes], object]) -> None:
        loop = asyncio.get_running_loop()
        if self.silent:
            return
        if self.mode == "raw":
            self.raw += data
            write(data.upper())
        elif self.mode == "cli":
            for letter in data:
                self._type(bytes([letter]), write)
        elif data == b"#":
            self.mode = "cli"
            write(b"\r\nEntering CLI Mode, type 'exit' to reboot, or 'help'\r\n\r\n# ")
        else:
            for frame in self.parser.feed(data):
                loop.call_later(self.delay, self._answer, frame, write)

    def restart(self) -> None:
        self.restarts += 1
        self.mode, self.silent, self.failed = "msp", True, False
        self.settings = dict(self.saved)
        asyncio.get_running_loop().call_later(REBOOT_TIME, self._boot)

    def _boot(self) -> None:
        self.silent = False

    def _answer(self, frame: Frame, write: Callable[[bytes], object]) -> None:
        self.received.append(frame)
        reply = self.replies.get(frame.command)
        payload = reply(frame.payload) if callable(reply) else reply
        direction = Direction.ERROR if payload is None else Direction.RESPONSE
        write(Frame(frame.command, payload or b"", direction, frame.version).encode())
        if frame.command == 245 and payload and any(payload):
            self.mode = "raw"
        if frame.command == 68:
            self.restart()

    def _type(self, letter: bytes, write: Callable[[bytes], object]) -> None:
        if letter != b"\n":
            self.line += letter
            write(letter)
            return
        if not self.line:
            return
        line, self.line = self.line.split(b"#")[0].decode().strip(), b""
        write(b"\r\n")
        write(self._command(line).replace("\n", "\r\n").encode())
        if self.mode == "cli":
            write(b"\r\n# ")

    def _command(self, line: str) -> str:
        words = line.split()
        match words:
            case []:
                return ""
            case ["diff", "all"]:
                values = "".join(f"set {name} = {value}\n" for name, value in self.settings.items())
                return f"\n# version\n# test\n\n# start\nbatch start\n{values}batch end\n\nsave"
            case ["set", name, "=", value] if name in self.settings:
                self.settings[name] = value
                return f"{name} set to {value}\n"
            case ["batch", _]:
                return "Command batch\n"
            case ["exit"] | ["save"]:
                if line == "save" and self.failed:
                    return "###ERROR IN save: PLEASE FIX ERRORS THEN 'SAVE'###"
                self.saved = dict(self.settings if line == "save" else self.saved)
                self.restart()
                return "\nRebooting"
        self.failed = True
        return f"###ERROR IN {words[0]}: INVALID NAME###\n"


async def run_firmware(firmware: Firmware, link: Link) -> None:
    """Connect the firmware with its end of the line."""
    channels: list[Channel] = []

    def receive(events: Sequence[LinkEvent]) -> None:
        for event in events:
            if isinstance(event, ChannelOpened):
                channels.append(event.channel)
            elif isinstance(event, BytesReceived):
                firmware.receive(event.data, event.channel.write)

    async with link:
        await link.read(receive)


@asynccontextmanager
async def controller_of(
    firmware: Firmware, impairment: Impairment | None = None
) -> AsyncIterator[FlightController]:
    """Open a client of the firmware."""
    near, far = memory_pair(asyncio.get_running_loop().time)
    task = asyncio.create_task(run_firmware(firmware, far))
    await asyncio.sleep(0)
    try:
        async with FlightController(impair(near, impairment) if impairment else near) as controller:
            yield controller
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
