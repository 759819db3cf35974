"""A stand-in for the flight controller of `betaflight.jsonl`: it answers each request as the real one did."""

from __future__ import annotations

import json
from pathlib import Path

from mavstack.msp import Direction, Frame, FrameParser
from mavstack.msp.firmware_info import FirmwareInfo

PATH = Path(__file__).with_name("betaflight.jsonl")


class RecordedController:
    """The replies of a recording, with the interface of `tests.sim.msp.peer.Peer` that pages need.

    Attributes:
        info: The firmware of the recording.
        replies: The payloads by command; None: the command was refused.
        requests: The commands of the requests that came, in their order.
    """

    def __init__(self) -> None:
        head, *lines = (json.loads(line) for line in PATH.read_text("ascii").splitlines())
        self.info = FirmwareInfo(head["variant"], api=tuple(head["api"]))
        self.replies: dict[int, bytes | None] = {
            each["command"]: None if each["payload"] is None else bytes.fromhex(each["payload"])
            for each in lines
        }
        self.requests: list[int] = []
        self._parser = FrameParser()

    def run(self, seconds: float) -> None:
        """Let time pass, in which a recording does nothing."""

    def send(self, data: bytes) -> bytes:
        """Return the replies to requests; a request that was not recorded sets a value, which is accepted."""
        return b"".join(self._reply(each).encode() for each in self._parser.feed(data))

    def _reply(self, request: Frame) -> Frame:
        self.requests.append(request.command)
        payload = self.replies.get(request.command, b"")
        direction = Direction.ERROR if payload is None else Direction.RESPONSE
        return Frame(request.command, payload or b"", direction, request.version)
