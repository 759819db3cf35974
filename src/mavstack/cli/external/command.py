"""`mav external`: measurements of a companion computer to a vehicle, from lines of text, until they end."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import add_connection_options, run_on_vehicle
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.stdin_lines import stdin_lines
from mavstack.errors import InvalidArgumentError, LinkURLError, RemoteError
from mavstack.links import BytesReceived, open_link
from mavstack.services.external import Frame
from mavstack.vehicle.external.records import KINDS, RecordReader, send_record

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator, Sequence

    from mavstack.links import Link
    from mavstack.links.events import LinkEvent
    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.external import ExternalStatus

EXAMPLES: Final = """\
examples:
  mav external odometry --url udpin://0.0.0.0:14550 < poses.csv        # time,x,y,z,qw,qx,qy,qz,vx,vy,vz
  mav external vision --udp 127.0.0.1:5005 --frame NED --body-frame FRD    # lines in datagrams
  my-tracker | mav external mocap --json          # {"position": [1, 2, 3], "orientation": [1, 0, 0, 0]}
  mav external landing-target < tags.csv          # time,forward,right,down in metres
  mav external obstacles < sectors.csv            # time,d0,d1,d2 ... in metres, clockwise from forward
  mav external gps < receiver.csv                 # time,latitude,longitude,altitude,vx,vy,vz
  mav external wind < station.csv                 # speed,direction in m/s and degrees, where it comes from
  mav external check --url udpin://0.0.0.0:14550  # do the settings let the estimator use estimates?
"""

_CHECK: Final = "check"
#: Seconds between two checks whether the estimator uses the messages.
_CHECK_INTERVAL: Final = 2.0
#: Maximum length of an input line; a line with 72 sectors and all digits is shorter.
_MAX_LINE: Final = 16_384
_AXES: Final = tuple(str(frame) for frame in Frame)
_PARTS: Final = frozenset({"position", "yaw"})


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    parser.add_argument(
        "kind", choices=(*KINDS, _CHECK), metavar="KIND",
        help=f"the measurements: {', '.join(KINDS)}; or check: why the estimator uses no estimates",
    )  # fmt: skip
    parser.add_argument(
        "--udp", metavar="HOST:PORT", help="receive the lines in datagrams at this address, not on stdin"
    )
    for name, default, summary in (
        ("--frame", Frame.ENU, "world of the poses: ENU, NED, FLU, FRD or RDF (default: ENU)"),
        ("--body-frame", Frame.FLU, "body of the poses: FLU, FRD or RDF (default: FLU)"),
    ):
        parser.add_argument(
            name, type=str.upper, choices=_AXES, default=str(default), metavar="AXES", help=summary
        )
    parser.add_argument("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")
    parser.add_argument("--json", action="store_true", help="print the counts and the reasons as JSON")
    add_connection_options(parser)
    parser.set_defaults(command="external")


def run(arguments: Namespace) -> int:
    """Run `mav external`."""
    if arguments.kind == _CHECK:
        return run_on_vehicle(arguments, lambda vehicle: _check(vehicle, as_json=arguments.json))
    link = _open(arguments.udp)

    async def work(vehicle: Vehicle) -> int:
        feed = _Feed(vehicle, arguments)
        lines = stdin_lines() if link is None else _datagram_lines(link)
        with suppress(TimeoutError):
            await asyncio.wait_for(feed.run(lines), arguments.duration)
        return feed.report()

    return run_on_vehicle(arguments, work)


def _open(address: str | None) -> Link | None:
    if address is None:
        return None
    try:
        return open_link(f"udpin://{address}")
    except LinkURLError as error:
        raise UsageError(str(error)) from None


async def _check(vehicle: Vehicle, *, as_json: bool) -> int:
    status = await vehicle.external.check(parts=_PARTS)
    if as_json:
        echo_json({"system": vehicle.system, "used": status.is_used, "reasons": list(status.reasons)})
    elif status.is_used:
        echo("the settings of the vehicle let its estimator use estimates")
    else:
        echo(str(status))
    return 0 if status.is_used else 1


async def _datagram_lines(link: Link) -> AsyncIterator[str]:
    """Yield the lines of all datagrams of a link; a datagram has whole lines."""
    lines: asyncio.Queue[str] = asyncio.Queue()

    def receive(events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case BytesReceived(data=data):
                    for line in data.decode(errors="replace").splitlines():
                        lines.put_nowait(line)

    async with link:
        announce_exposure("external", [link])
        reader = asyncio.get_running_loop().create_task(link.read(receive))
        try:
            while True:
                yield await lines.get()
        finally:
            reader.cancel()
            await asyncio.gather(reader, return_exceptions=True)


class _Feed:
    """Sends the records of a source, and reports the use by the estimator."""

    def __init__(self, vehicle: Vehicle, arguments: Namespace) -> None:
        self._vehicle, self._kind, self._as_json = vehicle, arguments.kind, arguments.json
        self._reader = RecordReader(arguments.kind)
        self._defaults = {"frame": arguments.frame, "body_frame": arguments.body_frame}
        self._sent = self._refused = 0
        self._problem = ""
        self._status: ExternalStatus | None = None

    async def run(self, lines: AsyncIterator[str]) -> None:
        if not self._as_json:
            echo(f"sending {self._kind} to {self._vehicle.address}")
        watch = asyncio.get_running_loop().create_task(self._watch())
        try:
            async for line in lines:
                await self._send(line)
            if KINDS[self._kind].is_pose and self._sent:
                await self._look()  # check before the measured rate falls, because nothing more is sent
        finally:
            watch.cancel()
            await asyncio.gather(watch, return_exceptions=True)

    async def _send(self, line: str) -> None:
        try:
            if len(line) > _MAX_LINE:
                raise InvalidArgumentError(f"the line is longer than {_MAX_LINE} characters")
            if (record := self._reader.read(line)) is not None:
                await send_record(self._vehicle.external, *record, self._defaults)
                self._sent += 1
        except (InvalidArgumentError, RemoteError) as error:
            self._refused += 1
            if str(error) != self._problem:
                self._problem = str(error)
                echo(f"mav external: record {self._sent + self._refused}: {error}", error=True)

    async def _watch(self) -> None:
        if not KINDS[self._kind].is_pose:
            return
        while True:
            await asyncio.sleep(_CHECK_INTERVAL)
            if self._sent:
                await self._look()

    async def _look(self) -> None:
        before = "" if self._status is None else str(self._status)
        self._status = await self._vehicle.external.check()
        if not self._as_json and str(self._status) != before:
            echo(f"{_figures(self._status)}: {self._status}")

    def report(self) -> int:
        """Print the counts; return the exit code, 1 if nothing was sent."""
        status = self._status
        if self._as_json:
            counts = {"system": self._vehicle.system, "sent": self._sent, "refused": self._refused}
            use = {} if status is None else {
                "rate": status.rate, "delay": status.delay, "used": status.is_used,
                "reasons": list(status.reasons),
            }  # fmt: skip
            echo_json(counts | use)
        else:
            echo(f"{self._sent} records sent, {self._refused} refused")
        return 0 if self._sent else 1


def _figures(status: ExternalStatus) -> str:
    delay = "" if status.delay is None else f", {status.delay * 1000:.0f} ms old"
    return f"{status.rate:.1f} Hz{delay}"
