"""Commands close to the wire: long, command_int, rc, nsh."""

from __future__ import annotations

import asyncio
import re
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.text import printable
from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell import completion
from mavstack.cli.shell.console_command import Command, expect, number_of, whole_number_of
from mavstack.dialects import ardupilotmega, common
from mavstack.errors import MavstackError
from mavstack.services.frames import GLOBAL_FRAMES
from mavstack.services.manual_control import RELEASE
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from enum import IntEnum

    from mavstack.cli.shell.session import Session
    from mavstack.node.shell import Shell

_LAST_COMMAND: Final = 0xFFFF
_CHANNELS: Final = range(1, 19)
_LONGEST_PULSE: Final = 3000
#: What whole numbers of places count on the wire: in degrees, and in metres.
_PLACES: Final = 1e7
_METRES: Final = 1e4
#: What PX4's shell writes when it waits for a line.
_PROMPT: Final = "nsh> "
#: How long to wait for a first word, and after the last one, in seconds.
FIRST_WORD: Final = 6.0
QUIET: Final = 4.0
_ESCAPES: Final = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")


def entry_of(kind: type[IntEnum], prefix: str, word: str, most: int) -> int:
    """An entry of an enum by its name, with or without what all begin with, or by its number."""
    if word.isascii() and word.isdecimal():
        return whole_number_of(word, prefix.rstrip("_"), most)
    name = word.upper().removeprefix(prefix)
    if name not in kind.__members__:
        raise UsageError(f"there is no {prefix}{name}")
    return int(kind[name])


async def command_long(session: Session, words: list[str]) -> None:
    """`long DO_SET_SERVO 8 1500`."""
    expect(words, 1, 8, "long COMMAND [PARAM]…")
    command = entry_of(ardupilotmega.MavCmd, "MAV_CMD_", words[0], _LAST_COMMAND)
    params = [number_of(word, f"param {place}") for place, word in enumerate(words[1:], 1)]
    vehicle = session.vehicle
    await with_status_texts(vehicle, vehicle.component.command(command, *params))
    session.say("accepted")


async def command_int(session: Session, words: list[str]) -> None:
    """`command_int GLOBAL_RELATIVE_ALT DO_SET_HOME 0 0 0 0 0 0 -353632120 1491659330 584`."""
    expect(words, 11, 11, "command_int FRAME COMMAND CURRENT AUTOCONTINUE P1 P2 P3 P4 X Y Z")
    frame = entry_of(common.MavFrame, "MAV_FRAME_", words[0], 255)
    command = entry_of(ardupilotmega.MavCmd, "MAV_CMD_", words[1], _LAST_COMMAND)
    for word in words[2:4]:
        whole_number_of(word, "current and autocontinue", 1)
    params = [number_of(word, "a param") for word in words[4:8]]
    scale = _PLACES if frame in GLOBAL_FRAMES else _METRES
    place = [_place(word, scale) for word in words[8:10]]
    vehicle = session.vehicle
    asked = vehicle.component.command(command, *params, *place, number_of(words[10], "z"), frame=frame)
    await with_status_texts(vehicle, asked)
    session.say("accepted")


async def rc(session: Session, words: list[str]) -> None:
    """`rc 3 1500`, `rc all 0`, `rc clear`; `rc` shows what is overridden."""
    vehicle = session.vehicle
    if [word.lower() for word in words] == ["clear"]:
        words = ["all", "0"]
    if words and words[0].lower() != "status":
        expect(words, 2, 2, "rc CHANNEL|all MICROSECONDS, rc clear, or rc status")
        pulse = whole_number_of(words[1], "the pulse", _LONGEST_PULSE)
        which = _CHANNELS if words[0].lower() == "all" else (_channel(words[0]),)
        await session.overrides.set(vehicle, dict.fromkeys(which, pulse or RELEASE))
    held = session.overrides.of(vehicle)
    texts = [f"{channel}: {pulse} µs" for channel, pulse in held.items()]
    session.say(f"overridden: {', '.join(texts) or 'nothing'}")


async def nsh(session: Session, words: list[str]) -> None:
    """`nsh ver all`: runs a line in PX4's shell."""
    expect(words, 1, None, "nsh COMMAND…")
    line = " ".join(words)
    async with session.vehicle.shell() as shell:
        shell.write_line(line)
        if not await _show_answer(session, shell, line):
            raise CommandError("no shell answered; it is PX4 that has one")


async def _show_answer(session: Session, shell: Shell, line: str) -> bool:
    """Print what the shell says to a line, without its prompts and the line; False if it says nothing."""
    heard, printed = "", 0
    while True:
        try:
            async with asyncio.timeout(QUIET if heard else FIRST_WORD):
                heard += await anext(shell)
        except (TimeoutError, StopAsyncIteration):
            break
        *whole, rest = _answer(heard, line)
        session.say(*whole[printed:])
        printed = max(printed, len(whole))
        if rest == _PROMPT.strip() and heard.count(_PROMPT) > 1:
            return True
    last = _answer(heard, line)[-1]
    if last and last != _PROMPT.strip():
        session.say(last)
    return bool(heard)


def _answer(heard: str, line: str) -> list[str]:
    """The lines of what was heard, the echo of the command left out; the last one may not be whole."""
    text = _ESCAPES.sub("", heard).replace("\r", "")
    *whole, last = [printable(each.expandtabs(8)).rstrip() for each in text.split("\n")]
    bare = [each.removeprefix(_PROMPT).strip() if each.startswith(_PROMPT) else each for each in whole]
    echoes = {line.strip(), _PROMPT.strip()}
    while bare and (not bare[0] or bare[0].strip() in echoes):
        del bare[0]
    return [*bare, last]


def _channel(word: str) -> int:
    number = whole_number_of(word, "the channel", _CHANNELS[-1])
    if number not in _CHANNELS:
        raise UsageError(f"there is no channel {number}; they go from 1 to {_CHANNELS[-1]}")
    return number


def _place(word: str, scale: float) -> float:
    """A whole number is as it is on the wire; one with a point is in degrees, or in metres."""
    value = number_of(word, "a place")
    return value / scale if word.lstrip("+-").isdecimal() else value


COMMANDS: Final = (
    Command(
        "long", "COMMAND [PARAM]…", "send a MAV_CMD as COMMAND_LONG", command_long,
        aliases=("command_long",), examples=("long DO_SET_SERVO 8 1500", "long MAV_CMD_GET_HOME_POSITION"),
        complete=completion.in_turn(completion.mav_commands),
    ),
    Command(
        "command_int", "FRAME COMMAND CURRENT AUTOCONTINUE P1 P2 P3 P4 X Y Z",
        "send a MAV_CMD as COMMAND_INT", command_int,
        examples=("command_int GLOBAL DO_SET_ROI_LOCATION 0 0 0 0 0 0 473985000 85460000 490",),
        details="X and Y: whole numbers are as on the wire (1e-7 degrees), numbers with a point in degrees.",
        complete=completion.in_turn(completion.frames, completion.mav_commands),
    ),
    Command(
        "rc", "CHANNEL|all MICROSECONDS | clear | status", "override channels of the radio control", rc,
        examples=("rc 3 1500", "rc all 0"), details="0 gives a channel back; so does leaving the shell.",
        complete=completion.in_turn(completion.one_of("all", "clear", "status")),
    ),
    Command(
        "nsh", "COMMAND…", "run a line in the shell of PX4", nsh, examples=("nsh ver all",),
        details="Ctrl-C ends it; quote what the shell here would take for its own: nsh 'ls; free'.",
    ),
)  # fmt: skip
