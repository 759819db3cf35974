"""`mav rtk`: corrections from a caster or a base to the vehicles of a link, until Ctrl-C."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import asdict
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import add_connection_options, run_on_vehicle
from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import align_columns, echo, echo_json
from mavstack.errors import LinkURLError
from mavstack.gnss import NtripURL
from mavstack.gnss.ublox import FixedPosition, SurveyIn
from mavstack.vehicle.rtk import FeedState, download_source_table

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.gnss import SourceTableEntry
    from mavstack.services.rtk import CorrectionCounts
    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.rtk import CorrectionFeed

EXAMPLES: Final = """\
examples:
  mav rtk ntrip://me:secret@caster.example.org:2101/MOUNT --url udpin://0.0.0.0:14550
  mav rtk ntrips://me:secret@caster.example.org/VRS     # over TLS; the vehicle's position is sent each 10 s
  mav rtk ntrip://caster.example.org:2101 --list        # the streams of a caster
  mav rtk tcpout://192.168.1.5:5015                     # a base that sends RTCM over TCP
  mav rtk serial:///dev/ttyACM0?baud=115200 --survey-in 120,1.5    # a u-blox base measures its position
  mav rtk serial:///dev/ttyACM0?baud=115200 --fixed 47.3977418,8.5455938,535.2
"""

#: Seconds between two checks of the GNSS fix of the vehicle.
_INTERVAL: Final = 0.5


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    parser.add_argument(
        "source", metavar="SOURCE", help="URL of a caster (ntrip://, ntrips://), or of the link to a base"
    )
    base = parser.add_mutually_exclusive_group()
    base.add_argument(
        "--survey-in", type=_survey, metavar="SECONDS,METRES",
        help="let a u-blox base measure its position first, for this time and to this accuracy",
    )  # fmt: skip
    base.add_argument(
        "--fixed", type=_position, metavar="LAT,LON,HEIGHT",
        help="the position of a u-blox base: degrees, and metres above the ellipsoid",
    )  # fmt: skip
    parser.add_argument("--list", action="store_true", help="print the streams of the caster, and end")
    parser.add_argument("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")
    parser.add_argument("--json", action="store_true", help="print the counts, or the streams, as JSON")
    add_connection_options(parser)
    parser.set_defaults(command="rtk")


def run(arguments: Namespace) -> int:
    """Run `mav rtk`."""
    if _lists(arguments):
        return run_until_signal(_list(arguments))
    base = arguments.survey_in or arguments.fixed

    async def work(vehicle: Vehicle) -> int:
        feed = vehicle.rtk.corrections(arguments.source, base=base)
        report = _Report(vehicle, feed, quiet=arguments.json)
        try:
            async with feed:
                await _run(feed, report, arguments.duration)
        finally:
            if arguments.json:
                echo_json(_document(vehicle, feed))
            else:
                echo(_summary(vehicle.rtk.counts))
        return 0

    return run_on_vehicle(arguments, work)


async def _run(feed: CorrectionFeed, report: _Report, duration: float | None) -> None:
    watch = asyncio.get_running_loop().create_task(report.watch())
    try:
        with suppress(TimeoutError):
            await asyncio.wait_for(feed.wait(), duration)
    finally:
        watch.cancel()
        await asyncio.gather(watch, return_exceptions=True)


class _Report:
    """Lines about changes: of the source, of the vehicle's fix, of problems with the frames."""

    def __init__(self, vehicle: Vehicle, feed: CorrectionFeed, *, quiet: bool) -> None:
        self._vehicle, self._feed = vehicle, feed
        self._fix = ""
        self._too_long = False
        self._survey: bool | None = None
        if not quiet:
            feed.on_change = self._changed
        self._quiet = quiet

    def _changed(self, feed: CorrectionFeed) -> None:
        if feed.state is FeedState.STREAMING:
            echo(f"receiving corrections from {feed.url}")
        elif feed.state is FeedState.WAITING:
            echo(f"{feed.url}: {feed.problem}; trying again", error=True)

    async def watch(self) -> None:
        while not self._quiet:
            self._look()
            await asyncio.sleep(_INTERVAL)

    def _look(self) -> None:
        status = self._vehicle.rtk.status
        if status.name != self._fix:
            self._fix = status.name
            echo(f"vehicle {self._vehicle.address}: {status.name}")
        survey = self._feed.survey
        if survey is not None and survey.is_valid != self._survey:
            self._survey = survey.is_valid
            state = "has its position" if survey.is_valid else "measures its position"
            echo(f"the base {state} ({survey.duration} s, {survey.accuracy:.2f} m)")
        if self._vehicle.rtk.counts.too_long and not self._too_long:
            self._too_long = True
            echo("frames of more than 720 bytes cannot be sent: use MSM4 instead of MSM7", error=True)


async def _list(arguments: Namespace) -> int:
    entries = await download_source_table(arguments.source)
    if arguments.json:
        echo_json([asdict(entry) for entry in entries])
    else:
        echo(*align_columns([("MOUNTPOINT", "PLACE", "FORMAT", "SYSTEMS", "GGA"), *map(_row, entries)]))
    return 0


def _row(entry: SourceTableEntry) -> tuple[str, ...]:
    return entry.mountpoint, entry.place, entry.format, entry.systems, "yes" if entry.needs_gga else "no"


def _lists(arguments: Namespace) -> bool:
    """Return whether the streams of a caster are asked for: by `--list`, or without a mountpoint."""
    if not arguments.source.startswith(("ntrip://", "ntrips://")):
        if arguments.list:
            raise UsageError("--list needs the URL of a caster, ntrip://HOST:PORT")
        return False
    try:
        url = NtripURL.parse(arguments.source)
    except LinkURLError as error:
        raise UsageError(str(error)) from None
    if arguments.survey_in or arguments.fixed:
        raise UsageError("--survey-in and --fixed need the link to a base, not a caster")
    return bool(arguments.list) or not url.mountpoint


def _summary(counts: CorrectionCounts) -> str:
    numbers = ", ".join(f"{number}: {count}" for number, count in sorted(counts.numbers.items()))
    parts = [f"{counts.frames} frames received ({counts.data} bytes), {counts.sent} sent"]
    parts += [f"{counts.thinned} repeated ones about the station left out"] * bool(counts.thinned)
    parts += [f"{counts.late} too late"] * bool(counts.late)
    parts += [f"{counts.too_long} too long"] * bool(counts.too_long)
    parts += [f"by message {numbers}"] * bool(numbers)
    return "; ".join(parts)


def _document(vehicle: Vehicle, feed: CorrectionFeed) -> dict[str, object]:
    return {
        "system": vehicle.system,
        "source": feed.url,
        "connects": feed.connects,
        "problem": feed.problem,
        "status": asdict(vehicle.rtk.status),
        "counts": asdict(vehicle.rtk.counts),
    }


def _survey(text: str) -> SurveyIn:
    return SurveyIn(*_numbers(text, 2))


def _position(text: str) -> FixedPosition:
    return FixedPosition(*_numbers(text, 3))


def _numbers(text: str, count: int) -> list[float]:
    numbers = [float(word) for word in text.split(",")]  # argparse reports a ValueError as wrong usage
    if len(numbers) != count:
        raise ValueError(text)
    return numbers
