"""Commands that look: info, status, watch, health, version, link, vehicle, ping."""

from __future__ import annotations

import asyncio
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.field_values import field_texts
from mavstack.cli.common.text import size_text
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import align_columns
from mavstack.cli.shell import completion
from mavstack.cli.shell.console_command import Command, expect, number_of, whole_number_of
from mavstack.cli.vehicle.info import gather_facts, page
from mavstack.dialects import Dialect
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from mavstack.cli.shell.session import Session
    from mavstack.dialects import Message
    from mavstack.vehicle import Vehicle

_LAST_SYSTEM: Final = 255
_READY_PATIENCE: Final = 60.0
#: How long to wait for a message that was not heard yet, in seconds.
_PATIENCE: Final = 5.0


async def info(session: Session, words: list[str]) -> None:
    """`info`."""
    expect(words, 0, 0, "info")
    session.say(*page(await gather_facts(session.vehicle)))


async def status(session: Session, words: list[str]) -> None:
    """`status`, `status GPS*`: what was heard last."""
    if not words:
        await info(session, [])
        return
    vehicle = session.vehicle
    heard = _heard(vehicle, words)
    if not heard and not any(set(word) & set("*?[") for word in words):
        kinds = _kinds(words)
        heard = [await vehicle.wait_for_message(kind, timeout=_PATIENCE) for kind in kinds]
    if not heard:
        raise CommandError(f"no {' nor '.join(words)} was heard of vehicle {vehicle.system}")
    for message in heard:
        session.say(message_line(message, vehicle.age(type(message))))


async def watch(session: Session, words: list[str]) -> None:
    """`watch ATTITUDE`, `watch GPS* 5`: messages as they come."""
    expect(words, 1, None, "watch MESSAGE… [SECONDS]")
    kinds, seconds = list(words), None
    if kinds[-1].replace(".", "", 1).isdecimal() and len(kinds) > 1:
        seconds = number_of(kinds.pop(), "the time")
    if seconds is None and not session.interactive:
        raise UsageError("say for how many seconds, as nobody can end it here: watch MESSAGE… SECONDS")
    chosen = _kinds(kinds)
    vehicle = session.vehicle
    try:
        async with (
            asyncio.timeout(seconds),
            vehicle.stream(*chosen, rate=session.settings.rate or None) as told,
        ):
            async for message in told:
                session.say(message_line(message))
    except TimeoutError as error:
        if isinstance(error, MavstackError):
            raise


async def health(session: Session, words: list[str]) -> None:
    """`health`: whether it is ready to arm, and why not."""
    expect(words, 0, 0, "health")
    facts = (await gather_facts(session.vehicle))["health"]
    head = {True: "ready to arm", False: "not ready to arm", None: "it does not say whether it is ready"}
    session.say(head[facts["ready"]], *(f"  {problem}" for problem in facts["problems"]))


async def ready(session: Session, words: list[str]) -> None:
    """`ready 60`: wait until it is ready to arm."""
    expect(words, 0, 1, "ready [SECONDS]")
    limit = number_of(words[0], "the time") if words else _READY_PATIENCE
    await session.vehicle.wait_until_ready(timeout=limit)


async def version(session: Session, words: list[str]) -> None:
    """`version`."""
    expect(words, 0, 0, "version")
    told = await session.vehicle.component.get_version()
    firmware = session.vehicle.component.info
    rows = [
        ("vehicle", firmware.kind if firmware else ""),
        ("firmware", f"{told.flight}{f' ({told.git_hash})' if told.git_hash else ''}"),
        ("middleware", str(told.middleware) if any(told.middleware) else ""),
        ("system", str(told.operating_system) if any(told.operating_system) else ""),
        ("board", f"vendor {told.vendor_id}, product {told.product_id}, version {told.board_version}"),
        ("id", told.unique_id),
    ]
    session.say(*align_columns([row for row in rows if row[1]]))


async def link(session: Session, words: list[str]) -> None:
    """`link`: what comes in over each link."""
    if [word.lower() for word in words] not in ([], ["list"]):
        raise UsageError("usage: link")
    for each in session.node.links:
        counters = each.counters
        session.say(f"{each.url}: {size_text(counters.bytes_in)} in, {size_text(counters.bytes_out)} out")
        for channel in each.channels:
            state = session.node.driver.channels.get(channel)
            if state is not None:
                told = state.parser.statistics
                session.say(
                    f"  {channel.name}: {told.packets} packets, {told.bad_bytes} bytes that are not MAVLink"
                )
        if not each.channels:
            session.say("  nobody is there")


async def vehicle(session: Session, words: list[str]) -> None:
    """`vehicle 2` means that one from now on; `vehicle` lists them."""
    expect(words, 0, 1, "vehicle [SYSTEM]")
    if words:
        session.choose(whole_number_of(words[0], "a system id", _LAST_SYSTEM))
        return
    rows = [_vehicle_row(session, each) for each in session.node.vehicles.values()]
    session.say(*(align_columns(rows) if rows else ["no vehicle has been heard yet"]))


async def ping(session: Session, words: list[str]) -> None:
    """`ping`: how long messages take there and back."""
    expect(words, 0, 0, "ping")
    told = await session.vehicle.component.ping()
    if not told.round_trips:
        raise CommandError(f"none of {told.sent} pings came back")
    times = [trip * 1000 for trip in told.round_trips]
    mean = sum(times) / len(times)
    spread = f"{min(times):.1f} to {max(times):.1f} ms, {mean:.1f} on the mean"
    session.say(f"{len(times)} of {told.sent} came back after {spread}")


def message_line(message: Message, age: float | None = None) -> str:
    """A message in one line."""
    fields = " ".join(f"{value.name}={value.text}" for value in field_texts(message) if value.known)
    name = type(message).definition.name
    return f"{name} {fields}" + ("" if age is None else f"  ({age:.1f} s ago)")


def _vehicle_row(session: Session, each: Vehicle) -> tuple[str, ...]:
    known = each.component.info
    state = "silent" if not each.alive else f"{each.mode or ''}{', armed' if each.armed else ''}"
    return "*" if each is session.chosen else " ", str(each.system), known.description if known else "", state


def _kinds(names: list[str]) -> list[type[Message]]:
    """Message classes by names or patterns."""
    dialect = Dialect.load("all")
    found: list[type[Message]] = []
    for name in names:
        fitting = [dialect[each] for each in dialect.names if fnmatchcase(each, name.upper())]
        if not fitting:
            raise UsageError(f"there is no message {name.upper()}")
        found += fitting
    return found


def _heard(vehicle: Vehicle, patterns: list[str]) -> list[Message]:
    dialect = Dialect.load("all")
    names = sorted(
        name for name in dialect.names if any(fnmatchcase(name, pattern.upper()) for pattern in patterns)
    )
    latest = (vehicle.latest(dialect[name]) for name in names)
    return [message for message in latest if message is not None]


COMMANDS: Final = (
    Command(
        "info", "", "what the vehicle is and how it is", info, examples=("info",),
    ),
    Command(
        "status", "[MESSAGE]…", "what was heard last; alone: as info", status,
        examples=("status HEARTBEAT", "status GPS*"), complete=completion.in_turn(rest=completion.messages),
    ),
    Command(
        "watch", "MESSAGE… [SECONDS]", "show messages as they come, until Ctrl-C", watch,
        examples=("watch HEARTBEAT 3",), complete=completion.in_turn(rest=completion.messages),
        details="`set rate 10` lets it ask for so many a second.",
    ),
    Command("health", "", "whether it is ready to arm, and why not", health, examples=("health",)),
    Command(
        "ready", "[SECONDS]", "wait until it is ready to arm (60 s at most)", ready, examples=("ready 90",)
    ),
    Command("version", "", "firmware and board of the vehicle", version, examples=("version",)),
    Command("link", "", "what comes in over each link", link, examples=("link",)),
    Command(
        "vehicle", "[SYSTEM]", "mean another vehicle; alone: list them", vehicle,
        examples=("vehicle", "vehicle 1"), complete=completion.in_turn(completion.systems),
    ),
    Command("ping", "", "how long messages take to the vehicle and back", ping, examples=("ping",)),
)  # fmt: skip
