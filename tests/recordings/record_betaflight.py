"""Recorder of `betaflight.jsonl`: the replies of Betaflight's SITL program to each request without arguments.

`MAVSTACK_BETAFLIGHT_SITL=PROGRAM python -m tests.recordings.record_betaflight` writes the file again. Its
first line names the firmware; each other line has the number of a command, and the payload of the reply or
null where the program refuses the command.
"""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from mavstack.bridges.msp import FlightController
from mavstack.errors import MspDenied
from mavstack.msp.messages import actions
from mavstack.msp.messages.registry import all_messages
from tests.interop.betaflight import URL, betaflight_sitl
from tests.recordings.controller import PATH

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

#: Their requests do something.
ACTIONS = {actions.RebootReply, actions.ResetConfReply, actions.PassthroughReply}
#: Version of the interface, variant, version, board, build, name, and identifier of the processor.
IDENTIFICATION = {1, 2, 3, 4, 5, 10, 160}


async def record(controller: FlightController) -> AsyncIterator[dict[str, Any]]:
    """Yield the lines of the file."""
    info = controller.info
    yield {"variant": info.variant, "api": list(info.api)}
    commands = {int(each.COMMAND) for each in all_messages() if each.IS_REPLY and each not in ACTIONS}
    for command in sorted(commands | IDENTIFICATION):
        try:
            payload = await controller.request(command)
        except MspDenied:
            yield {"command": command, "payload": None}
        else:
            yield {"command": command, "payload": payload.hex()}


async def main() -> None:
    """Record a program that was never set up."""
    with TemporaryDirectory() as folder, betaflight_sitl(Path(folder)) as sitl:
        await sitl.start()
        async with FlightController(URL) as controller:
            lines = [json.dumps(each) async for each in record(controller)]
    PATH.write_text("".join(f"{line}\n" for line in lines), "ascii")


if __name__ == "__main__":
    asyncio.run(main())
