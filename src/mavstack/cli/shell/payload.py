"""Commands for payloads: camera and gimbal; they run `mav camera` and `mav gimbal` with all their options."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError
from mavstack.cli.shell import completion
from mavstack.cli.shell.session import Command
from mavstack.cli.shell.subcommands import run_subcommand

if TYPE_CHECKING:
    from mavstack.cli.shell.session import Session

_YES: Final = frozenset({"-y", "--yes"})


async def camera(session: Session, words: list[str]) -> None:
    """Run an action of `camera`: `camera photo`, `camera zoom 50`."""
    if words[:1] == ["format"] and session.interactive and not _YES & set(words):
        if not await session.confirm(f"erase the storage of the camera of vehicle {session.vehicle.system}?"):
            raise CommandError("nothing was erased")
        words = [*words, "--yes"]
    await run_subcommand(session, "camera", words)


async def gimbal(session: Session, words: list[str]) -> None:
    """Run an action of `gimbal`: `gimbal point -45`, `gimbal center`."""
    await run_subcommand(session, "gimbal", words)


_start_or_stop = completion.by_position(completion.choice("start", "stop"))

COMMANDS: Final = (
    Command(
        "camera", "info|list|photo|stop|video|stream|mode|zoom|focus|settings|track|format|reset …",
        "images, video and settings of the camera", camera,
        examples=("camera info", "camera photo", "camera zoom 50", "camera mode video", "camera video start"),
        details="The options are those of `mav camera`: camera photo --help shows them.",
        complete=completion.subcommands(
            {
                **dict.fromkeys(("info", "list", "photo", "stop", "zoom", "settings", "reset")),
                **dict.fromkeys(("video", "stream"), _start_or_stop),
                "mode": completion.by_position(completion.choice("photo", "video", "survey")),
                "focus": completion.by_position(completion.choice("auto")),
                "track": completion.by_position(completion.choice("off")),
                "format": completion.by_position(completion.choice("--yes")),
            }
        ),
    ),
    Command(
        "gimbal", "info|point|turn|center|retract|roi|follow|watch|take|release …",
        "point the gimbal, and show where it points", gimbal,
        examples=("gimbal info", "gimbal point -45 30", "gimbal center", "gimbal roi off", "gimbal release"),
        details="The options are those of `mav gimbal`: gimbal point --help shows them. Actions that move "
        "the gimbal take control of it, which `gimbal release` gives up.",
        complete=completion.subcommands(
            {
                **dict.fromkeys(("info", "point", "turn", "center", "retract", "follow", "watch")),
                **dict.fromkeys(("take", "release")),
                "roi": completion.by_position(completion.choice("off")),
            }
        ),
    ),
)  # fmt: skip
