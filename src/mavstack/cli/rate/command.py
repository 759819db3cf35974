"""`mav rate`: show and set the rate at which a vehicle sends a message."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import add_connection_options, run_on_vehicle
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.options import add_dialect_option, message_ids
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.common.selection import of_vehicle, selects_several
from mavstack.dialects.lookup import find_dialect
from mavstack.services.message_request import DEFAULT, OFF, Interval

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Mapping

    from mavstack.dialects import Dialect
    from mavstack.services.message_request import RateSet
    from mavstack.vehicle import Vehicle

EXAMPLES: Final = """\
examples:
  mav rate ATTITUDE                       # show its rate
  mav rate ATTITUDE 20                    # set it to 20 Hz
  mav rate GPS_RAW_INT 0.5 --system 2     # vehicle 2 sends it every 2 s
  mav rate VIBRATION off
  mav rate ATTITUDE,VFR_HUD default --all # the default rates of all vehicles

A rate applies to the link over which it is set, until the vehicle reboots.
"""

_WORDS: Final[Mapping[str, Interval]] = {"default": DEFAULT, "off": OFF, "0": OFF}


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    parser.add_argument("message", metavar="MESSAGE", help="names, patterns (GPS*) or ids, with commas")
    parser.add_argument(
        "rate", nargs="?", metavar="HZ", help="rate in hertz, off or default; without it the rate is shown"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object per message")
    add_dialect_option(parser)
    add_connection_options(parser, fleet=True, changes=True)


def run(arguments: Namespace) -> int:
    """Run `mav rate`."""
    arguments.command = "rate"
    arguments.changes = arguments.rate is not None
    dialect = find_dialect(arguments.dialect)
    wanted = {_name(dialect, number): number for number in sorted(message_ids(dialect, arguments.message))}
    interval = None if arguments.rate is None else _interval(arguments.rate)

    async def work(vehicle: Vehicle) -> int:
        for name, number in wanted.items():
            if interval is None:
                known = await vehicle.component.get_message_interval(number)
                _print(arguments, vehicle, name, known, f"{name}: {_text(known)}")
            else:
                outcome = await vehicle.component.set_message_rate(number, interval)
                _print(arguments, vehicle, name, interval, f"{name}: {_text(interval)}{_note(outcome)}")
        return 0

    return run_on_vehicle(arguments, work)


def _interval(text: str) -> Interval:
    word = text.lower()
    if word in _WORDS:
        return _WORDS[word]
    try:
        return Interval.hertz(float(word))
    except ValueError:
        raise UsageError(
            f"{text!r} is not a rate: a number of hertz such as 5 or 0.5, off, or default"
        ) from None


def _text(interval: Interval) -> str:
    if interval == OFF:
        return "off"
    return "the default rate" if interval == DEFAULT else f"{interval.rate:.4g} Hz"


def _note(outcome: RateSet) -> str:
    return "" if outcome.whole_group is None else f", with its whole stream {outcome.whole_group}"


def _name(dialect: Dialect, number: int) -> str:
    return dialect[number].definition.name if number in dialect else f"message {number}"


def _print(arguments: Namespace, vehicle: Vehicle, name: str, interval: Interval, text: str) -> None:
    if arguments.json:
        rate = None if interval == DEFAULT else interval.rate
        echo_json({"system": vehicle.system, "message": name, "rate_hz": rate})
    else:
        echo(of_vehicle(vehicle, text) if selects_several(arguments) else text)
