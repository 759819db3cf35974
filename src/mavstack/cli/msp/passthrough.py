"""`mav msp passthrough`: connect another program with the ESCs or a serial port of a flight controller."""

from __future__ import annotations

import asyncio
import re
from argparse import ArgumentTypeError
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.msp.connection import run_on_controller
from mavstack.errors import InvalidArgumentError
from mavstack.links import open_link
from mavstack.links.events import BytesReceived

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.bridges.msp.connection import RawLine
    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.links import Link
    from mavstack.msp.firmware_info import FirmwareInfo

DEFAULT_OUT: Final = "tcpin://127.0.0.1:5770"
_PORT: Final = re.compile(r"(UART|SOFTSERIAL|VCP)(\d{0,2})")
#: Identifier of the first port of each kind: Betaflight from API 1.47 on; then older firmware and iNav.
_FIRST_PORTS: Final = {"UART": 51, "SOFTSERIAL": 30, "VCP": 20}
_FIRST_OLD_PORTS: Final = {"UART": 0, "SOFTSERIAL": 30, "VCP": 20}
_NEW_PORTS: Final = (1, 47)


def port_name(text: str) -> str:
    """Return the name of a serial port in capital letters.

    Raises:
        ArgumentTypeError: It is no name of a port.
    """
    match = _PORT.fullmatch(text.upper())
    if match is None or (match[1] == "VCP") is not (match[2] == "") or match[2].startswith("0"):
        raise ArgumentTypeError(f"{text!r} is no serial port, such as UART2, SOFTSERIAL1 or VCP")
    return text.upper()


def port_identifier(name: str, info: FirmwareInfo) -> int:
    """Return the identifier that a firmware gives to a port."""
    match = _PORT.fullmatch(name)
    if match is None:
        raise InvalidArgumentError(f"{name!r} is no serial port")
    is_new = info.is_betaflight and info.api >= _NEW_PORTS
    return (_FIRST_PORTS if is_new else _FIRST_OLD_PORTS)[match[1]] + int(match[2] or 1) - 1


def passthrough(arguments: Namespace) -> int:
    """Run `mav msp passthrough`."""

    async def work(controller: FlightController) -> int:
        port = None if arguments.esc else port_identifier(arguments.port, controller.info)
        async with open_link(arguments.out) as link, controller.passthrough(port) as line:
            where = "the ESCs" if arguments.esc else arguments.port
            _announce(arguments, link, where)
            await _pump(link, line)
        return 0

    return run_on_controller(arguments, work)


def _announce(arguments: Namespace, link: Link, where: str) -> None:
    address = link.address
    text = f"{link.url.scheme}://{address[0]}:{address[1]}" if address else link.url.redacted
    if arguments.json:
        echo_json({"out": text, "connected_with": where})
    else:
        echo(
            f"{text} is connected with {where}; Ctrl-C to end",
            "the controller speaks MSP again after a restart",
        )


async def _pump(link: Link, line: RawLine) -> None:
    """Pass the bytes in both directions until one side ends."""

    async def forward() -> None:
        async for event in link:
            if isinstance(event, BytesReceived):
                line.write(event.data)

    async def backward() -> None:
        while True:
            data = await line.read()
            for channel in link.channels:
                channel.write(data)

    tasks = [asyncio.create_task(forward()), asyncio.create_task(backward())]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in done:
            task.result()
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
