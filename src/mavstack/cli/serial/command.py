"""`mav serial`: a serial port of a vehicle, or its position as NMEA, for other programs until Ctrl-C."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from math import atan2, degrees
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import add_connection_options, run_on_vehicle
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.options import finite_number, seconds
from mavstack.cli.common.output import echo, echo_json
from mavstack.errors import InvalidArgumentError, LinkURLError
from mavstack.gnss import Fix, format_gga, format_rmc
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, open_link
from mavstack.node.serial_port import DEFAULT_POLL, port_names

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Sequence

    from mavstack.links import Channel, Link
    from mavstack.links.events import LinkEvent
    from mavstack.node.serial_port import SerialPort
    from mavstack.vehicle import Vehicle

EXAMPLES: Final = """\
examples:
  mav serial --device gps1 --pty /tmp/ttyGPS --url udpin://0.0.0.0:14550   # a terminal for other programs
  mav serial --device gps1 --baud 38400 --tcp 127.0.0.1:5001               # a TCP port
  mav serial --device telem2 --pty /tmp/ttyESC --shared                    # the autopilot uses it too
  mav serial --nmea --tcp 127.0.0.1:10110 --rate 5                         # for chart plotters
  mav serial --nmea --out udpout://127.0.0.1:10110                         # for gpsd: gpsd udp://127.0.0.1:10110
"""

_MIN_RATE, _MAX_RATE = 0.1, 20.0


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        "--device", choices=port_names(), metavar="NAME", help=f"the port: {', '.join(port_names())}"
    )
    what.add_argument("--nmea", action="store_true", help="the position of any vehicle as GGA and RMC")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--pty", metavar="PATH", help="make a terminal of this name (not on Windows)")
    where.add_argument("--tcp", metavar="HOST:PORT", help="listen on a TCP port")
    where.add_argument("--out", metavar="URL", help="any other link, such as udpout://HOST:PORT")
    parser.add_argument("--baud", type=int, default=0, metavar="RATE", help="baud rate of the port")
    parser.add_argument("--shared", action="store_true", help="the autopilot uses the port meanwhile too")
    parser.add_argument(
        "--rate", type=finite_number, default=1.0, metavar="HZ", help="NMEA positions per second (default: 1)"
    )
    parser.add_argument("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")
    parser.add_argument("--json", action="store_true", help="print the counts of bytes as JSON at the end")
    add_connection_options(parser)
    parser.set_defaults(command="serial")


def run(arguments: Namespace) -> int:
    """Run `mav serial`."""
    if not _MIN_RATE <= arguments.rate <= _MAX_RATE:
        raise UsageError(f"--rate must be from {_MIN_RATE:g} to {_MAX_RATE:g}")
    try:
        link = open_link(_url(arguments))
    except LinkURLError as error:
        raise UsageError(str(error)) from None

    async def work(vehicle: Vehicle) -> int:
        relay = _Relay(link)
        async with link:
            announce_exposure("serial", [link])
            if not arguments.json:
                echo(
                    f"{'NMEA' if arguments.nmea else arguments.device} of {vehicle.address} at {_place(link)}"
                )
            try:
                with suppress(TimeoutError):
                    await asyncio.wait_for(_relay(vehicle, relay, arguments), arguments.duration)
            finally:
                if arguments.json:
                    echo_json({"to_vehicle": relay.received, "from_vehicle": relay.sent, "lost": relay.lost})
        return 0

    return run_on_vehicle(arguments, work)


def _url(arguments: Namespace) -> str:
    if arguments.pty:
        return f"pty://{Path(arguments.pty).absolute()}"
    return f"tcpin://{arguments.tcp}" if arguments.tcp else str(arguments.out)


def _place(link: Link) -> str:
    return link.url.redacted.removeprefix("pty://")


async def _relay(vehicle: Vehicle, relay: _Relay, arguments: Namespace) -> None:
    reader = asyncio.get_running_loop().create_task(relay.read())
    try:
        if arguments.nmea:
            await _send_positions(vehicle, relay, 1.0 / arguments.rate)
        else:
            ports = vehicle.component.serial
            async with ports.open(
                arguments.device, baudrate=arguments.baud, exclusive=not arguments.shared, poll=DEFAULT_POLL
            ) as port:
                relay.port = port
                async for data in port:
                    relay.write(data)
    finally:
        relay.port = None
        reader.cancel()
        await asyncio.gather(reader, return_exceptions=True)


async def _send_positions(vehicle: Vehicle, relay: _Relay, interval: float) -> None:
    while True:
        if (sentences := _sentences(vehicle)) is not None:
            relay.write(sentences)
        await asyncio.sleep(interval)


def _sentences(vehicle: Vehicle) -> bytes | None:
    """Return the position of a vehicle; None before it is known."""
    position, gps, velocity = vehicle.position, vehicle.gps, vehicle.velocity
    if position is None or position.altitude is None:
        return None
    fix = Fix(
        vehicle.component.now(),
        position.latitude,
        position.longitude,
        position.altitude,
        3 if gps is None else int(gps.fix),
        (gps.satellites or 0) if gps else 0,
        gps.hdop if gps and gps.hdop is not None else 1.0,
    )
    if velocity is None:
        return format_gga(fix) + format_rmc(fix)
    course = degrees(atan2(velocity.east, velocity.north))
    return format_gga(fix) + format_rmc(fix, velocity.ground_speed, course)


class _Relay:
    """The channels of a link, and the port that their bytes go to."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._channels: list[Channel] = []
        self.port: SerialPort | None = None
        self.received = self.sent = self.lost = 0

    async def read(self) -> None:
        await self._link.read(self._receive)

    def write(self, data: bytes) -> None:
        self.sent += len(data)
        for channel in self._channels:
            channel.write(data)

    def _receive(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case ChannelOpened(channel):
                    self._channels.append(channel)
                case ChannelClosed(channel):
                    self._channels.remove(channel)
                case BytesReceived(data=data) if self.port is not None:
                    self._forward(self.port, data)

    def _forward(self, port: SerialPort, data: bytes) -> None:
        try:
            port.write(data)
        except InvalidArgumentError:
            # the queue is full: the link to the vehicle is slower than the local program
            self.lost += len(data)
        else:
            self.received += len(data)
