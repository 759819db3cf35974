"""`mav msp info`: the firmware, the board and the name of a flight controller."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.cli.msp.connection import run_on_controller

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.msp.firmware_info import FirmwareInfo


def info(arguments: Namespace) -> int:
    """Run `mav msp info`."""

    async def work(controller: FlightController) -> int:
        if arguments.json:
            echo_json(_document(controller.info))
        else:
            echo(*align_columns(_rows(controller.info)))
        return 0

    return run_on_controller(arguments, work)


def _document(who: FirmwareInfo) -> dict[str, object]:
    return {
        "firmware": who.firmware,
        "variant": who.variant,
        "version": who.version_text,
        "api": api_text(who),
        "board": who.board,
        "target": who.target,
        "build": who.build,
        "name": who.name,
        "uid": who.uid,
    }


def _rows(who: FirmwareInfo) -> list[tuple[str, str]]:
    rows = [
        ("firmware", f"{who.firmware} {who.version_text} ({who.variant})"),
        ("MSP version", api_text(who)),
        ("board", f"{who.board} {who.target}".strip() if who.target != who.board else who.board),
        ("build", who.build),
        ("name", who.name),
        ("identifier", who.uid),
    ]
    return [(label, text) for label, text in rows if text]


def api_text(who: FirmwareInfo) -> str:
    """Return the version of the MSP interface."""
    return ".".join(map(str, who.api))
