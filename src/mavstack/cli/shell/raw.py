"""Low-level commands: long, command_int, rc, nsh."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.text import printable
from mavstack.cli.shell import completion
from mavstack.cli.shell.console_command import expect_words, parse_integer, parse_number
from mavstack.cli.shell.nsh import ESCAPES, FIRST_ANSWER_TIMEOUT, NO_ANSWER, PROMPT, run_session
from mavstack.cli.shell.session import Command
from mavstack.dialects import ardupilotmega, common
from mavstack.services.frames import GLOBAL_FRAMES
from mavstack.services.manual_control import RELEASE

if TYPE_CHECKING:
    from enum import IntEnum

    from mavstack.cli.shell.session import Session
    from mavstack.node.shell import Shell

_MAX_COMMAND: Final = 0xFFFF
_CHANNELS: Final = range(1, 19)
_MAX_PULSE: Final = 3000
#: Scale of integer positions in messages: units per degree, and units per metre.
_PER_DEGREE: Final = 1e7
_PER_METRE: Final = 1e4
#: Seconds without further characters after which an answer is complete.
QUIET_TIMEOUT: Final = 4.0


def enum_value(enum: type[IntEnum], prefix: str, word: str, maximum: int) -> int:
    """Parse an entry of an enum: its name with or without the prefix, or its number."""
    if word.isascii() and word.isdecimal():
        return parse_integer(word, prefix.rstrip("_"), maximum)
    name = word.upper().removeprefix(prefix)
    if name not in enum.__members__:
        raise UsageError(f"there is no {prefix}{name}")
    return int(enum[name])


async def command_long(session: Session, words: list[str]) -> None:
    """Run `long DO_SET_SERVO 8 1500`."""
    expect_words(words, 1, 8, "long COMMAND [PARAM]…")
    command = enum_value(ardupilotmega.MavCmd, "MAV_CMD_", words[0], _MAX_COMMAND)
    params = [parse_number(word, f"param {index}") for index, word in enumerate(words[1:], 1)]
    vehicle = session.vehicle
    await vehicle.command(command, *params)
    session.print("accepted")


async def command_int(session: Session, words: list[str]) -> None:
    """Run `command_int GLOBAL_RELATIVE_ALT DO_SET_HOME 0 0 0 0 0 0 -353632120 1491659330 584`."""
    expect_words(words, 11, 11, "command_int FRAME COMMAND CURRENT AUTOCONTINUE P1 P2 P3 P4 X Y Z")
    frame = enum_value(common.MavFrame, "MAV_FRAME_", words[0], 255)
    command = enum_value(ardupilotmega.MavCmd, "MAV_CMD_", words[1], _MAX_COMMAND)
    for word in words[2:4]:
        parse_integer(word, "current and autocontinue", 1)
    params = [parse_number(word, "a param") for word in words[4:8]]
    scale = _PER_DEGREE if frame in GLOBAL_FRAMES else _PER_METRE
    position = [_coordinate(word, scale) for word in words[8:10]]
    vehicle = session.vehicle
    await vehicle.command(command, *params, *position, parse_number(words[10], "z"), frame=frame)
    session.print("accepted")


async def rc(session: Session, words: list[str]) -> None:
    """Run `rc 3 1500`, `rc all 0`, `rc clear` or `rc`, which shows the overridden channels."""
    vehicle = session.vehicle
    if [word.lower() for word in words] == ["clear"]:
        words = ["all", "0"]
    if words and words[0].lower() != "status":
        expect_words(words, 2, 2, "rc CHANNEL|all MICROSECONDS, rc clear, or rc status")
        pulse = parse_integer(words[1], "the pulse", _MAX_PULSE)
        channels = _CHANNELS if words[0].lower() == "all" else (_channel(words[0]),)
        await session.overrides.set(vehicle, dict.fromkeys(channels, pulse or RELEASE))
    active = session.overrides.active(vehicle)
    texts = [f"{channel}: {pulse} µs" for channel, pulse in active.items()]
    session.print(f"overridden: {', '.join(texts) or 'none'}")


async def nsh(session: Session, words: list[str]) -> None:
    """Run `nsh ver all`: a line in PX4's shell; without words, a session in it."""
    if not words and session.reader is not None:
        async with session.vehicle.shell() as shell:
            await run_session(session, shell)
        return
    expect_words(words, 1, None, "nsh COMMAND… (on a terminal also: nsh)")
    line = " ".join(words)
    async with session.vehicle.shell() as shell:
        shell.write_line(line)
        if not await _show_answer(session, shell, line):
            raise CommandError(NO_ANSWER)


async def _show_answer(session: Session, shell: Shell, line: str) -> bool:
    """Print the answer of the shell without prompts and echo; return False if there is none."""
    received, printed = "", 0
    while True:
        try:
            async with asyncio.timeout(QUIET_TIMEOUT if received else FIRST_ANSWER_TIMEOUT):
                received += await anext(shell)
        except (TimeoutError, StopAsyncIteration):
            break
        *complete, rest = _answer_lines(received, line)
        session.print(*complete[printed:])
        printed = max(printed, len(complete))
        if rest == PROMPT.strip() and received.count(PROMPT) > 1:
            return True
    last = _answer_lines(received, line)[-1]
    if last and last != PROMPT.strip():
        session.print(last)
    return bool(received)


def _answer_lines(received: str, line: str) -> list[str]:
    """Return the lines of an answer without the echo of the command; the last line may be incomplete."""
    text = ESCAPES.sub("", received).replace("\r", "")
    *complete, last = [printable(each.expandtabs(8)).rstrip() for each in text.split("\n")]
    answer = [each.removeprefix(PROMPT).strip() if each.startswith(PROMPT) else each for each in complete]
    echoes = {line.strip(), PROMPT.strip()}
    while answer and (not answer[0] or answer[0].strip() in echoes):
        del answer[0]
    return [*answer, last]


def _channel(word: str) -> int:
    number = parse_integer(word, "the channel", _CHANNELS[-1])
    if number not in _CHANNELS:
        raise UsageError(f"there is no channel {number}; channels are 1 to {_CHANNELS[-1]}")
    return number


def _coordinate(word: str, scale: float) -> float:
    """Parse a coordinate: an integer in the unit of the wire, or a decimal number in degrees or metres."""
    value = parse_number(word, "a coordinate")
    return value / scale if word.lstrip("+-").isdecimal() else value


COMMANDS: Final = (
    Command(
        "long", "COMMAND [PARAM]…", "send a MAV_CMD as COMMAND_LONG", command_long,
        aliases=("command_long",), examples=("long DO_SET_SERVO 8 1500", "long MAV_CMD_GET_HOME_POSITION"),
        complete=completion.by_position(completion.mav_commands),
    ),
    Command(
        "command_int", "FRAME COMMAND CURRENT AUTOCONTINUE P1 P2 P3 P4 X Y Z",
        "send a MAV_CMD as COMMAND_INT", command_int,
        examples=("command_int GLOBAL DO_SET_ROI_LOCATION 0 0 0 0 0 0 473985000 85460000 490",),
        details="X and Y are integers as on the wire (1e-7 degrees), or decimal numbers in degrees.",
        complete=completion.by_position(completion.frames, completion.mav_commands),
    ),
    Command(
        "rc", "CHANNEL|all MICROSECONDS | clear | status", "override RC channels", rc,
        examples=("rc 3 1500", "rc all 0"), details="0 releases a channel. Leaving the shell releases all.",
        complete=completion.by_position(completion.choice("all", "clear", "status")),
    ),
    Command(
        "nsh", "[COMMAND…]", "a session in the shell of PX4, or one line of it", nsh,
        examples=("nsh ver all",),
        details="Without COMMAND the session has a history of its own; Ctrl-C interrupts the command on the "
        "vehicle, Ctrl-D leaves. Quote characters that this shell interprets: nsh 'ls; free'.",
    ),
)  # fmt: skip
