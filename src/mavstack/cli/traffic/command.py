"""`mav traffic`: aircraft of a receiver to the vehicles of a link, with alarms, until Ctrl-C."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import add_connection_options, run_on_vehicle
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import finite_number, seconds
from mavstack.cli.common.output import align_columns, coloured, echo, echo_json
from mavstack.errors import LinkURLError
from mavstack.vehicle import Connection
from mavstack.vehicle.traffic import TrafficFeed
from mavstack.vehicle.traffic.feed import DEFAULT_COUNT, DEFAULT_REACH

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.vehicle import Vehicle
    from mavstack.vehicle.traffic import TrafficAlarm

EXAMPLES: Final = """\
examples:
  mav traffic sbs://127.0.0.1:30003 --url udpin://0.0.0.0:14550   # dump1090, its text
  mav traffic beast://127.0.0.1:30005 --fleet                     # dump1090, its frames; own vehicles too
  mav traffic gdl90://0.0.0.0:4000 --count 10 --reach 20          # receivers for tablets; 10 within 20 km
  mav traffic sbs://127.0.0.1 --for 60 --json                     # the aircraft and the counts at the end
"""

_KILOMETRE: Final = 1000.0
_MAX_COUNT: Final = 500


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    parser.add_argument("source", metavar="SOURCE", help="sbs://, beast:// or gdl90://HOST:PORT")
    parser.add_argument(
        "--count", type=int, default=DEFAULT_COUNT, metavar="N",
        help=f"aircraft shown to each vehicle (default: {DEFAULT_COUNT})",
    )  # fmt: skip
    parser.add_argument(
        "--reach", type=finite_number, default=DEFAULT_REACH / _KILOMETRE, metavar="KM",
        help=f"the largest distance from a vehicle (default: {DEFAULT_REACH / _KILOMETRE:g})",
    )  # fmt: skip
    parser.add_argument("--fleet", action="store_true", help="show the vehicles each other as aircraft too")
    parser.add_argument("--for", dest="duration", type=seconds, metavar="SECONDS", help="end after this time")
    parser.add_argument("--json", action="store_true", help="print aircraft, counts and alarms as JSON")
    add_connection_options(parser)
    parser.set_defaults(command="traffic")


def run(arguments: Namespace) -> int:
    """Run `mav traffic`."""
    if not 1 <= arguments.count <= _MAX_COUNT or arguments.reach <= 0:
        raise UsageError(f"--count must be from 1 to {_MAX_COUNT}, and --reach positive")

    async def work(vehicle: Vehicle) -> int:
        connection = vehicle.connection
        assert isinstance(connection, Connection)  # noqa: S101 (of `connect`)
        try:
            feed = TrafficFeed(
                connection,
                arguments.source,
                count=arguments.count,
                reach=arguments.reach * _KILOMETRE,
                fleet=arguments.fleet,
            )
        except LinkURLError as error:
            raise UsageError(str(error)) from None
        alarms: list[TrafficAlarm] = []
        async with feed:
            if not arguments.json:
                echo(f"showing vehicles the traffic of {arguments.source}")
            try:
                with suppress(TimeoutError):
                    await asyncio.wait_for(_watch(feed, alarms, quiet=arguments.json), arguments.duration)
            finally:
                _report(feed, alarms, as_json=arguments.json)
        return 0

    return run_on_vehicle(arguments, work)


async def _watch(feed: TrafficFeed, alarms: list[TrafficAlarm], *, quiet: bool) -> None:
    async for alarm in feed.alarms():
        alarms.append(alarm)
        if not quiet:
            echo(coloured(_alarm_text(alarm), "alarm"))


def _alarm_text(alarm: TrafficAlarm) -> str:
    name = alarm.aircraft.callsign or f"{alarm.aircraft.address:06X}"
    time, horizontal, vertical = alarm.approach
    return (
        f"vehicle {alarm.system}: {name} passes at {horizontal:.0f} m, {vertical:.0f} m above or below, "
        f"in {time:.0f} s"
    )


def _alarm_as_json(alarm: TrafficAlarm) -> dict[str, object]:
    return {
        "system": alarm.system,
        "aircraft": alarm.aircraft._asdict(),
        "approach": alarm.approach._asdict(),
    }


def _report(feed: TrafficFeed, alarms: list[TrafficAlarm], *, as_json: bool) -> None:
    aircraft = feed.aircraft.all()
    if as_json:
        listed = [each._asdict() for each in aircraft]
        raised = [_alarm_as_json(alarm) for alarm in alarms]
        echo_json({"reports": feed.reports, "sent": feed.sent, "aircraft": listed, "alarms": raised})
        return
    rows = [
        (f"{each.address:06X}", each.callsign or "-", *(_text(value) for value in _values(each)))
        for each in aircraft[-20:]
    ]
    if rows:
        echo(*align_columns([("ADDRESS", "CALLSIGN", "LAT", "LON", "ALT m", "m/s"), *rows]))
    if not aircraft and feed.problem:
        echo(f"no traffic was received: {feed.problem}", error=True)
    echo(f"{len(aircraft)} aircraft, {feed.reports} reports, {feed.sent} messages sent, {len(alarms)} alarms")


def _values(aircraft: object) -> list[float | None]:
    return [getattr(aircraft, name) for name in ("latitude", "longitude", "altitude", "speed")]


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.4f}".rstrip("0").rstrip(".")
