"""Commands that arm and fly: arm, mode, takeoff, guided, land, rtl …"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell import completion
from mavstack.cli.shell.console_command import Command, expect, number_of
from mavstack.cli.vehicle.flight_progress import FlightProgress, height_of, to_altitude, to_home, to_place
from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Awaitable

    from mavstack.cli.shell.session import Session
    from mavstack.cli.vehicle.flight_progress import Left

_TAKEOFF_ALTITUDE: Final = 10.0
_REBOOT_TO_BOOTLOADER: Final = 3.0


def _how(session: Session) -> dict[str, Any]:
    """What the settings say about waiting."""
    return {"wait": session.settings.wait, "timeout": session.settings.limit or None}


async def _fly(session: Session, what: str, action: Awaitable[None], left: Left | None = None) -> None:
    async with FlightProgress(session.vehicle, what, left):
        await action


async def arm(session: Session, words: list[str]) -> None:
    """`arm`, `arm throttle`, `arm throttle force`."""
    options = [word.lower() for word in words]
    if options[:1] == ["throttle"]:
        del options[0]
    if options not in ([], ["force"]):
        raise UsageError("usage: arm [throttle] [force]")
    await session.vehicle.arm(force=bool(options))
    session.say("armed")


async def disarm(session: Session, words: list[str]) -> None:
    """`disarm`, `disarm force`."""
    if [word.lower() for word in words] not in ([], ["force"]):
        raise UsageError("usage: disarm [force]")
    await session.vehicle.disarm(force=bool(words))
    session.say("disarmed")


async def takeoff(session: Session, words: list[str]) -> None:
    """`takeoff 20`."""
    expect(words, 0, 1, "takeoff [ALTITUDE]")
    altitude = number_of(words[0], "the altitude") if words else _TAKEOFF_ALTITUDE
    await _fly(session, "takeoff", session.vehicle.takeoff(altitude, **_how(session)), to_altitude(altitude))


async def land(session: Session, words: list[str]) -> None:
    """`land`."""
    expect(words, 0, 0, "land")
    await _fly(session, "land", session.vehicle.land(**_how(session)), height_of)


async def rtl(session: Session, words: list[str]) -> None:
    """`rtl`."""
    expect(words, 0, 0, "rtl")
    await _fly(session, "rtl", session.vehicle.rtl(**_how(session)), to_home)


async def hold(session: Session, words: list[str]) -> None:
    """`hold`."""
    expect(words, 0, 0, "hold")
    await session.vehicle.hold()


async def goto(session: Session, words: list[str]) -> None:
    """`guided LAT LON ALT`; `guided` alone is the mode."""
    if not words:
        await mode(session, ["guided"])
        return
    expect(words, 2, 3, "guided LAT LON [ALTITUDE]")
    latitude, longitude = number_of(words[0], "the latitude"), number_of(words[1], "the longitude")
    altitude = number_of(words[2], "the altitude") if len(words) == 3 else None
    action = session.vehicle.goto(latitude, longitude, altitude, **_how(session))
    await _fly(session, "going there", action, to_place(latitude, longitude))


async def orbit(session: Session, words: list[str]) -> None:
    """`orbit LAT LON ALT RADIUS SPEED`."""
    expect(words, 2, 5, "orbit LAT LON [ALTITUDE [RADIUS [SPEED]]]")
    names = ("the latitude", "the longitude", "the altitude", "the radius", "the speed")
    numbers = [number_of(word, name) for word, name in zip(words, names, strict=False)]
    latitude, longitude, *more = numbers
    altitude, radius, speed, *_ = [*more, None, None, None][:3] if more else (None, None, None)
    action = session.vehicle.orbit(
        latitude, longitude, altitude, radius=20.0 if radius is None else radius, speed=speed, **_how(session)
    )
    await _fly(session, "orbit", action, to_place(latitude, longitude))


async def mode(session: Session, words: list[str]) -> None:
    """`mode guided`; `mode` alone lists them."""
    if not words:
        await modes(session, [])
        return
    name = " ".join(words)
    await session.vehicle.set_mode(int(name) if name.isascii() and name.isdecimal() else name)


async def modes(session: Session, words: list[str]) -> None:
    """`modes`."""
    expect(words, 0, 0, "modes")
    vehicle = session.vehicle
    found = await vehicle.modes.list()
    now = (vehicle.mode or "").lower()
    session.say(*(f"{'*' if each.name.lower() == now else ' '} {each.name}" for each in found))


async def speed(session: Session, words: list[str]) -> None:
    """`setspeed 5`."""
    expect(words, 1, 1, "setspeed METRES_PER_SECOND")
    wanted = number_of(words[0], "the speed")
    await session.vehicle.set_speed(wanted)


async def yaw(session: Session, words: list[str]) -> None:
    """`setyaw 90`, or with a rate and whether it is relative, as MAVProxy has it."""
    expect(words, 1, 3, "setyaw DEGREES [DEGREES_PER_SECOND [0|1]]")
    names = ("the heading", "the rate", "whether it is relative")
    heading, *more = [number_of(word, name) for word, name in zip(words, names, strict=False)]
    if not more:
        await _fly(session, "turning", session.vehicle.set_yaw(heading, **_how(session)))
        return
    relative = bool(more[1:] and more[1])
    direction = (1 if heading >= 0 else -1) if relative else 0
    angle = abs(heading) if relative else heading % 360.0
    asked = session.vehicle.component.command(
        common.MavCmd.CONDITION_YAW, angle, more[0], direction, float(relative)
    )
    await with_status_texts(session.vehicle, asked)


async def home(session: Session, words: list[str]) -> None:
    """`home`, `home set`, `home LAT LON [ALT]`."""
    here = [word.lower() for word in words] in (["set"], ["here"])
    if words and not here:
        expect(words, 2, 3, "home [set | LAT LON [ALTITUDE above sea]]")
    place = [] if here else [number_of(word, "home") for word in words]
    vehicle = session.vehicle
    if words:
        await vehicle.set_home(*place)
    else:
        await vehicle.telemetry.ask_for_home()
    where = vehicle.home
    if where is None:
        raise CommandError("the vehicle has no home yet")
    session.say(f"home: {where.latitude:.7f} {where.longitude:.7f}, {where.altitude:.1f} m above sea")


async def reboot(session: Session, words: list[str]) -> None:
    """`reboot`."""
    options = [word.lower() for word in words]
    if options == ["bootloader"]:
        asked = session.vehicle.component.command(
            common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN, _REBOOT_TO_BOOTLOADER
        )
        await with_status_texts(session.vehicle, asked)
        return
    expect(words, 0, 0, "reboot [bootloader]")
    session.remembered.clear()
    await session.vehicle.reboot(wait=session.settings.wait)


COMMANDS: Final = (
    Command(
        "arm", "[throttle] [force]", "let the motors run", arm,
        examples=("arm throttle", "arm throttle force"),
        details="With force the vehicle skips its own checks as far as it lets itself be told.",
        complete=completion.in_turn(completion.one_of("throttle", "force"), completion.one_of("force")),
    ),
    Command(
        "disarm", "[force]", "stop the motors", disarm, examples=("disarm", "disarm force"),
        details="With force also in the air.", complete=completion.in_turn(completion.one_of("force")),
    ),
    Command(
        "takeoff", "[ALTITUDE]", "take off to an altitude above home (10 m), and stay there", takeoff,
        examples=("takeoff 20",),
    ),
    Command("land", "", "land where it is", land, examples=("land",)),
    Command("rtl", "", "return home, and land there", rtl, examples=("rtl",)),
    Command("hold", "", "stay where it is; a wing circles", hold, examples=("hold",)),
    Command(
        "guided", "[LAT LON [ALTITUDE]]", "go to a place; alone: enter GUIDED", goto, aliases=("goto",),
        examples=("guided 47.3985 8.5460 30",),
        details="The altitude is in metres above home; without one it stays as high as it is.",
    ),
    Command(
        "orbit", "LAT LON [ALTITUDE [RADIUS [SPEED]]]", "circle a place", orbit,
        examples=("orbit 47.3985 8.5460 30 40",),
        details="A negative radius is flown counter-clockwise.",
    ),
    Command(
        "mode", "[NAME]", "enter a flight mode; alone: list them", mode, examples=("mode guided", "mode"),
        details="The name of a mode alone does it too: loiter.",
        complete=completion.in_turn(completion.modes),
    ),
    Command("modes", "", "list the flight modes", modes, examples=("modes",)),
    Command(
        "setspeed", "METRES_PER_SECOND", "fly so fast over ground", speed, aliases=("speed",),
        examples=("setspeed 5",),
    ),
    Command(
        "setyaw", "DEGREES [DEGREES_PER_SECOND [0|1]]", "turn to a heading", yaw, aliases=("yaw",),
        examples=("setyaw 90", "setyaw 30 20 1"), details="A 1 at the end: from where it points now.",
    ),
    Command(
        "home", "[set | LAT LON [ALTITUDE]]", "show where home is, or set it", home,
        examples=("home", "home set", "home 47.3978 8.5457 488"),
        complete=completion.in_turn(completion.one_of("set")),
    ),
    Command(
        "reboot", "[bootloader]", "reboot the autopilot, and wait until it is back", reboot,
        examples=("reboot",), complete=completion.in_turn(completion.one_of("bootloader")),
    ),
)  # fmt: skip
