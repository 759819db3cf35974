"""Commands that inspect: info, status, watch, health, ready, version, link, vehicle, ping."""

from __future__ import annotations

import asyncio
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import DEFAULT_HEARTBEAT_TIMEOUT
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.field_values import field_texts
from mavstack.cli.common.output import align_columns
from mavstack.cli.common.selection import DISCOVERY_TIME
from mavstack.cli.common.text import size_text
from mavstack.cli.common.wrapping import terminal_columns
from mavstack.cli.shell import completion
from mavstack.cli.shell.console_command import expect_words, parse_integer, parse_number
from mavstack.cli.shell.session import Command
from mavstack.cli.shell.subcommands import run_subcommand
from mavstack.cli.vehicle.info import gather_facts, page, readiness
from mavstack.dialects import Dialect
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from mavstack.cli.shell.session import Session
    from mavstack.dialects import Message
    from mavstack.vehicle import Vehicle

_MAX_SYSTEM: Final = 255
_READY_TIMEOUT: Final = 60.0
#: Seconds to wait for a message that has not been received yet.
_MESSAGE_TIMEOUT: Final = 5.0


async def info(session: Session, words: list[str]) -> None:
    """Run `info`."""
    expect_words(words, 0, 0, "info")
    session.print(*page(await gather_facts(session.vehicle), terminal_columns()))


async def status(session: Session, words: list[str]) -> None:
    """Run `status` or `status GPS*`: the latest messages."""
    if not words:
        await info(session, [])
        return
    vehicle = session.vehicle
    latest = _latest_messages(vehicle, words)
    if not latest and not any(set(word) & set("*?[") for word in words):
        wanted = _message_classes(words)
        latest = [await vehicle.wait_for_message(each, timeout=_MESSAGE_TIMEOUT) for each in wanted]
    if not latest:
        raise CommandError(f"vehicle {vehicle.system} has sent no {' and no '.join(words)}")
    for message in latest:
        session.print(message_line(message, vehicle.age(type(message))))


async def watch(session: Session, words: list[str]) -> None:
    """Run `watch ATTITUDE` or `watch GPS* 5`: messages as they arrive."""
    expect_words(words, 1, None, "watch MESSAGE… [SECONDS]")
    names, seconds = list(words), None
    if names[-1].replace(".", "", 1).isdecimal() and len(names) > 1:
        seconds = parse_number(names.pop(), "the time")
    if seconds is None and not session.interactive:
        raise UsageError("a script needs the number of seconds: watch MESSAGE… SECONDS")
    chosen = _message_classes(names)
    vehicle = session.vehicle
    try:
        async with (
            asyncio.timeout(seconds),
            vehicle.stream(*chosen, rate=session.settings.rate or None) as messages,
        ):
            async for message in messages:
                session.print(message_line(message))
    except TimeoutError as error:
        if isinstance(error, MavstackError):
            raise


async def health(session: Session, words: list[str]) -> None:
    """Run `health`: readiness to arm and problems."""
    expect_words(words, 0, 0, "health")
    facts = (await gather_facts(session.vehicle))["health"]
    session.print(readiness(facts), *(f"  {problem}" for problem in facts["problems"]))


async def ready(session: Session, words: list[str]) -> None:
    """Run `ready 60`: wait until the vehicle is ready to arm."""
    expect_words(words, 0, 1, "ready [SECONDS]")
    timeout = parse_number(words[0], "the time") if words else _READY_TIMEOUT
    await session.vehicle.wait_until_ready(timeout=timeout)


async def version(session: Session, words: list[str]) -> None:
    """Run `version`."""
    expect_words(words, 0, 0, "version")
    reported = await session.vehicle.component.get_version()
    firmware = session.vehicle.component.info
    rows = [
        ("vehicle", firmware.description if firmware else ""),
        ("firmware", f"{reported.flight}{f' ({reported.git_hash})' if reported.git_hash else ''}"),
        ("middleware", str(reported.middleware) if any(reported.middleware) else ""),
        ("system", str(reported.operating_system) if any(reported.operating_system) else ""),
        (
            "board",
            f"vendor {reported.vendor_id}, product {reported.product_id}, version {reported.board_version}",
        ),
        ("id", reported.unique_id),
    ]
    session.print(*align_columns([row for row in rows if row[1]]))


async def rate(session: Session, words: list[str]) -> None:
    """Run `rate ATTITUDE` or `rate ATTITUDE 20`: like `mav rate`."""
    await run_subcommand(session, "rate", words)


async def link(session: Session, words: list[str]) -> None:
    """Run `link`: the traffic of each link."""
    if [word.lower() for word in words] not in ([], ["list"]):
        raise UsageError("usage: link")
    for each in session.connection.links:
        counters = each.counters
        session.print(f"{each.url}: {size_text(counters.bytes_in)} in, {size_text(counters.bytes_out)} out")
        for channel in each.channels:
            state = session.connection.channel_state(channel)
            if state is not None:
                total = state.parser.statistics
                session.print(
                    f"  {channel.name}: {total.packets} packets, {total.bad_bytes} bytes that are not MAVLink"
                )
        if not each.channels:
            session.print("  no peer")


async def vehicle(session: Session, words: list[str]) -> None:
    """Run `vehicle 2`, which selects a vehicle, or `vehicle`, which lists them."""
    expect_words(words, 0, 1, "vehicle [SYSTEM]")
    waiting = session.wait_for_vehicle is not None  # true in a script that has not used a vehicle yet
    if words:
        system = parse_integer(words[0], "a system id", _MAX_SYSTEM)
        if waiting:
            await session.connection.wait_for_vehicle(system, timeout=DEFAULT_HEARTBEAT_TIMEOUT)
        session.select(system)
        return
    if waiting:
        await session.connection.wait_for_vehicle(timeout=DEFAULT_HEARTBEAT_TIMEOUT)
        await asyncio.sleep(DISCOVERY_TIME)
    rows = [_vehicle_row(session, each) for each in session.connection.vehicles.values()]
    session.print(*(align_columns(rows) if rows else ["no vehicle has been heard yet"]))


async def ping(session: Session, words: list[str]) -> None:
    """Run `ping`: the round-trip times."""
    expect_words(words, 0, 0, "ping")
    result = await session.vehicle.component.ping()
    if not result.round_trips:
        raise CommandError(f"none of {result.sent} pings was answered")
    times = [trip * 1000 for trip in result.round_trips]
    mean = sum(times) / len(times)
    spread = f"{min(times):.1f} to {max(times):.1f} ms, mean {mean:.1f} ms"
    session.print(f"{len(times)} of {result.sent} pings answered: {spread}")


def message_line(message: Message, age: float | None = None) -> str:
    """Return a message in one line."""
    fields = " ".join(f"{value.name}={value.text}" for value in field_texts(message) if value.known)
    name = type(message).definition.name
    return f"{name} {fields}" + ("" if age is None else f"  ({age:.1f} s ago)")


def _vehicle_row(session: Session, each: Vehicle) -> tuple[str, ...]:
    known = each.component.info
    state = "silent" if not each.alive else f"{each.mode or ''}{', armed' if each.armed else ''}"
    return (
        "*" if each is session.selected else " ",
        str(each.system),
        known.description if known else "",
        state,
    )


def _message_classes(names: list[str]) -> list[type[Message]]:
    """Return the message classes of names or patterns."""
    dialect = Dialect.load("all")
    found: list[type[Message]] = []
    for name in names:
        matching = [dialect[each] for each in dialect.names if fnmatchcase(each, name.upper())]
        if not matching:
            raise UsageError(f"there is no message {name.upper()}")
        found += matching
    return found


def _latest_messages(vehicle: Vehicle, patterns: list[str]) -> list[Message]:
    dialect = Dialect.load("all")
    names = sorted(
        name for name in dialect.names if any(fnmatchcase(name, pattern.upper()) for pattern in patterns)
    )
    latest = (vehicle.latest(dialect[name]) for name in names)
    return [message for message in latest if message is not None]


COMMANDS: Final = (
    Command(
        "info", "", "show identity, state and health of the vehicle", info, examples=("info",),
    ),
    Command(
        "status", "[MESSAGE]…", "show the latest messages; without arguments as info", status,
        examples=("status HEARTBEAT", "status GPS*"),
        complete=completion.by_position(rest=completion.messages),
    ),
    Command(
        "watch", "MESSAGE… [SECONDS]", "show messages as they arrive, until Ctrl-C", watch,
        examples=("watch HEARTBEAT 3",), complete=completion.by_position(rest=completion.messages),
        details="After `set rate 10` the messages are requested at 10 Hz.",
    ),
    Command(
        "health", "", "show whether the vehicle is ready to arm, and why not", health,
        examples=("health",),
    ),
    Command(
        "ready", "[SECONDS]", "wait until the vehicle is ready to arm (default: 60 s)", ready,
        examples=("ready 90",),
    ),
    Command(
        "rate", "MESSAGE [HZ|off|default]", "show or set how often a message is sent", rate,
        examples=("rate ATTITUDE", "rate ATTITUDE 20", "rate VIBRATION off"),
        complete=completion.by_position(completion.messages, completion.choice("off", "default")),
    ),
    Command("version", "", "show firmware and board of the vehicle", version, examples=("version",)),
    Command("link", "", "show the traffic of each link", link, examples=("link",), needs_vehicle=False),
    Command(
        "vehicle", "[SYSTEM]", "select a vehicle; without arguments list the vehicles", vehicle,
        needs_vehicle=False,
        examples=("vehicle", "vehicle 1"), complete=completion.by_position(completion.systems),
    ),
    Command("ping", "", "measure the round-trip time to the vehicle", ping, examples=("ping",)),
)  # fmt: skip
