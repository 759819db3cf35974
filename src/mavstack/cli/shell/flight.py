"""Commands that arm and fly: arm, mode, takeoff, guided, land, rtl and others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.output import echo
from mavstack.cli.shell import completion
from mavstack.cli.shell.console_command import expect_words, parse_number
from mavstack.cli.shell.session import Command
from mavstack.cli.vehicle.flight_progress import (
    distance_to_altitude,
    distance_to_home,
    distance_to_place,
    flight_progress,
    height_above_home,
)
from mavstack.cli.vehicle.interruption import notice_of_interruption
from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Awaitable

    from mavstack.cli.shell.session import Session
    from mavstack.cli.vehicle.flight_progress import Remaining

_TAKEOFF_ALTITUDE: Final = 10.0
_REBOOT_TO_BOOTLOADER: Final = 3.0


def _wait_options(session: Session) -> dict[str, Any]:
    """Return the arguments of an action that follow from the settings."""
    return {"wait": session.settings.wait, "timeout": session.settings.timeout or None}


async def _fly(
    session: Session, title: str, action: Awaitable[None], remaining: Remaining | None = None
) -> None:
    with notice_of_interruption(session.vehicle, title):
        async with flight_progress(session.vehicle, title, remaining):
            await action


async def arm(session: Session, words: list[str]) -> None:
    """Run `arm`, `arm throttle`, `arm throttle force` or `arm allow-flight`."""
    options = [word.lower() for word in words]
    if options[:1] == ["throttle"]:
        del options[0]
    if len(set(options)) < len(options) or not set(options) <= {"force", "allow-flight"}:
        raise UsageError("usage: arm [throttle] [force] [allow-flight]")
    await session.vehicle.arm(force="force" in options, allow_flight="allow-flight" in options)
    session.report("armed")


async def disarm(session: Session, words: list[str]) -> None:
    """Run `disarm` or `disarm force`."""
    if [word.lower() for word in words] not in ([], ["force"]):
        raise UsageError("usage: disarm [force]")
    await session.vehicle.disarm(force=bool(words))
    session.report("disarmed")


async def takeoff(session: Session, words: list[str]) -> None:
    """Run `takeoff 20`."""
    expect_words(words, 0, 1, "takeoff [ALTITUDE]")
    altitude = parse_number(words[0], "the altitude") if words else _TAKEOFF_ALTITUDE
    await _fly(
        session,
        "takeoff",
        session.vehicle.takeoff(altitude, **_wait_options(session)),
        distance_to_altitude(altitude),
    )


async def land(session: Session, words: list[str]) -> None:
    """Run `land`."""
    expect_words(words, 0, 0, "land")
    await _fly(session, "land", session.vehicle.land(**_wait_options(session)), height_above_home)


async def rtl(session: Session, words: list[str]) -> None:
    """Run `rtl`."""
    expect_words(words, 0, 0, "rtl")
    await _fly(session, "rtl", session.vehicle.rtl(**_wait_options(session)), distance_to_home)


async def hold(session: Session, words: list[str]) -> None:
    """Run `hold`."""
    expect_words(words, 0, 0, "hold")
    await session.vehicle.hold()


async def goto(session: Session, words: list[str]) -> None:
    """Run `guided LAT LON ALT`; `guided` alone sets the mode."""
    if not words:
        await mode(session, ["guided"])
        return
    expect_words(words, 2, 3, "guided LAT LON [ALTITUDE]")
    latitude, longitude = parse_number(words[0], "the latitude"), parse_number(words[1], "the longitude")
    altitude = parse_number(words[2], "the altitude") if len(words) == 3 else None
    action = session.vehicle.goto(latitude, longitude, altitude, **_wait_options(session))
    await _fly(session, "goto", action, distance_to_place(latitude, longitude))


async def orbit(session: Session, words: list[str]) -> None:
    """Run `orbit LAT LON ALT RADIUS SPEED`."""
    expect_words(words, 2, 5, "orbit LAT LON [ALTITUDE [RADIUS [SPEED]]]")
    names = ("the latitude", "the longitude", "the altitude", "the radius", "the speed")
    numbers = [parse_number(word, name) for word, name in zip(words, names, strict=False)]
    latitude, longitude, *more = numbers
    altitude, radius, speed, *_ = [*more, None, None, None][:3] if more else (None, None, None)
    action = session.vehicle.orbit(
        latitude,
        longitude,
        altitude,
        radius=20.0 if radius is None else radius,
        speed=speed,
        **_wait_options(session),
    )
    await _fly(session, "orbit", action, distance_to_place(latitude, longitude))


async def mode(session: Session, words: list[str]) -> None:
    """Run `mode guided`; `mode` alone lists the modes."""
    if not words:
        await modes(session, [])
        return
    name, vehicle = " ".join(words), session.vehicle
    await vehicle.set_mode(int(name) if name.isascii() and name.isdecimal() else name)
    echo(f"mode {vehicle.mode or name}")


async def modes(session: Session, words: list[str]) -> None:
    """Run `modes`."""
    expect_words(words, 0, 0, "modes")
    vehicle = session.vehicle
    found = await session.list_modes(vehicle)
    current = (vehicle.mode or "").lower()
    session.print(*(f"{'*' if each.name.lower() == current else ' '} {each.name}" for each in found))


async def speed(session: Session, words: list[str]) -> None:
    """Run `setspeed 5`."""
    expect_words(words, 1, 1, "setspeed METRES_PER_SECOND")
    ground_speed = parse_number(words[0], "the speed")
    await session.vehicle.set_speed(ground_speed)


async def yaw(session: Session, words: list[str]) -> None:
    """Run `setyaw 90`, or `setyaw DEGREES RATE RELATIVE` as in MAVProxy."""
    expect_words(words, 1, 3, "setyaw DEGREES [DEGREES_PER_SECOND [0|1]]")
    names = ("the heading", "the rate", "relative (0 or 1)")
    heading, *more = [parse_number(word, name) for word, name in zip(words, names, strict=False)]
    if not more:
        await _fly(session, "yaw", session.vehicle.set_yaw(heading, **_wait_options(session)))
        return
    relative = bool(more[1:] and more[1])
    direction = (1 if heading >= 0 else -1) if relative else 0
    angle = abs(heading) if relative else heading % 360.0
    await session.vehicle.command(common.MavCmd.CONDITION_YAW, angle, more[0], direction, float(relative))


async def home(session: Session, words: list[str]) -> None:
    """Run `home`, `home set` or `home LAT LON [ALT]`."""
    here = [word.lower() for word in words] in (["set"], ["here"])
    if words and not here:
        expect_words(words, 2, 3, "home [set | LAT LON [ALTITUDE above sea]]")
    place = [] if here else [parse_number(word, "home") for word in words]
    vehicle = session.vehicle
    if words:
        await vehicle.set_home(*place)
    else:
        await vehicle.telemetry.request_home()
    position = vehicle.home
    if position is None:
        raise CommandError(f"vehicle {vehicle.system} has no home position yet")
    session.print(
        f"home: {position.latitude:.7f} {position.longitude:.7f}, {position.altitude:.1f} m above sea"
    )


async def reboot(session: Session, words: list[str]) -> None:
    """Run `reboot` or `reboot bootloader`."""
    options = [word.lower() for word in words]
    if options == ["bootloader"]:
        await session.vehicle.command(common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN, _REBOOT_TO_BOOTLOADER)
        return
    expect_words(words, 0, 0, "reboot [bootloader]")
    session.completion_cache.clear()
    session.listed_modes.clear()
    with notice_of_interruption(session.vehicle, "reboot"):
        await session.vehicle.reboot(wait=session.settings.wait)


COMMANDS: Final = (
    Command(
        "arm", "[throttle] [force] [allow-flight]", "arm the motors", arm,
        examples=("arm throttle", "arm throttle force", "arm allow-flight"),
        details="`force` overrides the checks of the vehicle as far as its firmware allows. "
        "`allow-flight` arms also in a mode in which the vehicle starts at once, such as TAKEOFF or AUTO.",
        complete=completion.by_position(
            completion.choice("throttle", "force", "allow-flight"),
            completion.choice("force", "allow-flight"),
        ),
    ),
    Command(
        "disarm", "[force]", "disarm the motors", disarm, examples=("disarm", "disarm force"),
        details="`force` disarms also in the air.",
        complete=completion.by_position(completion.choice("force")),
    ),
    Command(
        "takeoff", "[ALTITUDE]", "take off to an altitude, and hold there", takeoff,
        examples=("takeoff 20",),
        details="The altitude is in metres above home; the default is 10.",
    ),
    Command("land", "", "land at the current position", land, examples=("land",)),
    Command("rtl", "", "return to home, and land there", rtl, examples=("rtl",)),
    Command("hold", "", "hold the position; a fixed wing circles", hold, examples=("hold",)),
    Command(
        "guided", "[LAT LON [ALTITUDE]]", "fly to a place; without arguments set the mode GUIDED", goto,
        aliases=("goto",), examples=("guided 47.3985 8.5460 30",),
        details="The altitude is in metres above home; the default is the current altitude.",
    ),
    Command(
        "orbit", "LAT LON [ALTITUDE [RADIUS [SPEED]]]", "circle around a place", orbit,
        examples=("orbit 47.3985 8.5460 30 40",),
        details="A negative radius is counter-clockwise.",
    ),
    Command(
        "mode", "[NAME]", "set the flight mode; without arguments list the modes", mode,
        examples=("mode guided", "mode"), details="The name of a mode is a command too: loiter.",
        complete=completion.by_position(completion.modes),
    ),
    Command("modes", "", "list the flight modes", modes, examples=("modes",)),
    Command(
        "setspeed", "METRES_PER_SECOND", "set the ground speed", speed, aliases=("speed",),
        examples=("setspeed 5",),
    ),
    Command(
        "setyaw", "DEGREES [DEGREES_PER_SECOND [0|1]]", "turn to a heading", yaw, aliases=("yaw",),
        examples=("setyaw 90", "setyaw 30 20 1"),
        details="With 1 at the end the angle is relative to the heading.",
    ),
    Command(
        "home", "[set | LAT LON [ALTITUDE]]", "show or set the home position", home,
        examples=("home", "home set", "home 47.3978 8.5457 488"),
        complete=completion.by_position(completion.choice("set")),
    ),
    Command(
        "reboot", "[bootloader]", "reboot the autopilot, and wait until it is back", reboot,
        examples=("reboot",), complete=completion.by_position(completion.choice("bootloader")),
    ),
)  # fmt: skip
