"""Firmware: the ports of the station, files that clients send, and flashing."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from shutil import which
from typing import TYPE_CHECKING, Annotated, Any, Final

from msgspec import Meta, Struct

from mavstack.flashing import FlashOptions, list_ports, parse_firmware
from mavstack.flashing.firmware_file import MAX_FILE_SIZE
from mavstack.flashing.json_text import board_json, file_json, result_json
from mavstack.flashing.ports import has_modem_manager
from mavstack.http.bodies import RefusedError
from mavstack.http.request_fields import Fields
from mavstack.http.routes import RouteTable, Wait
from mavstack.security.roles import Role
from mavstack.server.api_route import AnyRoute, ApiRoute, Call, PlainCall
from mavstack.server.request_types import Text

if TYPE_CHECKING:
    from mavstack.flashing import FirmwareFile, Phase
    from mavstack.server.tasks import Task

_TOOLS: Final = ("dfu-util", "esptool")
_NAME: Final = Meta(description="The name of the file, for errors and for the board of a radio.")
_PORT: Final = Meta(description="The serial port or the URL.", examples=["/dev/ttyACM0"])


class FileQuery(Fields):
    """The query of a file that is only checked."""

    name: Annotated[Text, _NAME] = "firmware"


class PortQuery(Fields):
    """The query of a board in its bootloader."""

    port: Annotated[Text, _PORT]


class FlashQuery(Wait, kw_only=True):
    """The query of flashing."""

    port: Annotated[Text, _PORT]
    name: Annotated[Text, _NAME] = "firmware"
    dry_run: Annotated[bool, Meta(description="Only check, and write nothing.")] = False
    backup: Annotated[bool, Meta(description="Save the parameters before and restore them after.")] = True
    board: Annotated[
        Text | None, Meta(description="The board of a radio, if the name of its file does not say.")
    ] = None


class Port(Struct):
    """A serial port of the station; `board` is known by the USB ids, and may be empty."""

    device: str
    board: str
    description: str
    usb: str
    serial: str
    in_bootloader: bool


class Ports(Struct):
    """The ports, and the programs that flash further devices."""

    ports: list[Port]
    modem_manager: bool
    tools: dict[str, bool]


class FirmwareFacts(Struct):
    """The facts of a firmware file."""

    kind: str
    name: str
    version: str
    board: int | None
    size: int
    external_size: int
    max_size: int | None
    signed: bool
    usb: list[str]


class RestoredParameters(Struct):
    """The parameters that were restored, and the names of those that were not."""

    file: str
    set: int
    unchanged: int
    failed: list[str]


class FlashAnswer(Struct):
    """The result of flashing; `parameters` is null if none were restored."""

    board: str
    dry_run: bool
    written: int
    attempts: int
    parameters: RestoredParameters | None
    notes: list[str]


_FACTS: Final = {
    "kind": "px4",
    "name": "PX4FMUv5",
    "version": "v1.15.4",
    "board": 50,
    "size": 1958400,
    "external_size": 0,
    "max_size": 2064384,
    "signed": False,
    "usb": [],
}
_RESULT: Final = {
    "board": "board 50, Pixhawk 4 (FMUv5)",
    "dry_run": False,
    "written": 1958400,
    "attempts": 1,
    "parameters": {"file": "…-restored.params", "set": 3, "unchanged": 1021, "failed": []},
    "notes": [],
}
ROUTES: Final[RouteTable[AnyRoute]] = RouteTable(ApiRoute, "firmware")


@ROUTES.add(
    "GET",
    "/api/firmware/ports",
    "List the serial ports of the station, with the boards at them",
    role=Role.ADMINISTER,
    answer={"ports": [], "modem_manager": False, "tools": {"dfu-util": True, "esptool": False}},
    answer_model=Ports,
)
async def _ports(_: PlainCall) -> dict[str, Any]:
    found = await asyncio.to_thread(list_ports)
    return {
        "ports": [asdict(each) for each in found],
        "modem_manager": has_modem_manager(),
        "tools": {name: which(name) is not None for name in _TOOLS},
    }


@ROUTES.add(
    "POST",
    "/api/firmware/check",
    "Check a firmware file, and show for which board it is",
    role=Role.ADMINISTER,
    takes_bytes=True,
    max_body=MAX_FILE_SIZE,
    answer=_FACTS,
    answer_model=FirmwareFacts,
)
async def _check(call: Call[None, FileQuery]) -> dict[str, Any]:
    return file_json(await _firmware(call, call.query.name))


@ROUTES.add(
    "GET",
    "/api/firmware/board",
    "Show the board that is in its bootloader at a port",
    role=Role.ADMINISTER,
    answer={"board": 50, "name": "board 50, Pixhawk 4 (FMUv5)", "flash_size": 2064384},
)
async def _board(call: Call[None, PortQuery]) -> dict[str, Any]:
    board = await call.station.flasher.identify(call.query.port)
    if board is None:
        raise RefusedError(404, f"no bootloader answers at {call.query.port}")
    return board_json(board)


@ROUTES.add(
    "POST",
    "/api/firmware/flash",
    "Check a firmware, and write it to the device at a port",
    role=Role.ADMINISTER,
    takes_bytes=True,
    max_body=MAX_FILE_SIZE,
    answer=_RESULT,
    answer_model=FlashAnswer,
)
async def _flash(call: Call[None, FlashQuery]) -> dict[str, Any]:
    query = call.query
    firmware = await _firmware(call, query.name)
    options = FlashOptions(
        dry_run=query.dry_run,
        keep_parameters=query.backup,
        radio_board=query.board,
        report=_Report(call.task),
    )
    result = await call.station.flasher.flash(firmware, query.port, options)
    return result_json(result, dry_run=query.dry_run)


async def _firmware(call: Call[None, Any], name: str) -> FirmwareFile:
    """Parse the file that the client sent."""
    return await asyncio.to_thread(parse_firmware, call.data, name)


class _Report:
    """Reports the phase and the bytes to the task that a client follows."""

    def __init__(self, task: Task | None) -> None:
        self._task = task

    def __call__(self, phase: Phase, done: int, total: int) -> None:
        if self._task is not None:
            self._task.report(done, total)
            self._task.report_step({"phase": str(phase)})
