"""Commands for the data that a vehicle stores: param, wp, fence, rally, mission, ftp, log.

They run `mav param`, `mav mission`, `mav ftp` and `mav log` with all their options, under the names that
users of MAVProxy type.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.param.download import download_parameters
from mavstack.cli.shell import completion
from mavstack.cli.shell.console_command import expect_words, parse_integer
from mavstack.cli.shell.session import Command
from mavstack.cli.shell.subcommands import run_subcommand
from mavstack.dialects import common

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mavstack.cli.shell.session import Session

_MAX_ITEM: Final = 0xFFFE
_HELP: Final = ("-h", "--help")
_FTP: Final = ("ls", "get", "put", "rm", "mkdir", "rename", "crc")
_PLANS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "load": ("upload",),
        "upload": ("upload",),
        "save": ("download",),
        "download": ("download",),
        "list": ("show", "--no-map"),
        "show": ("show",),
        "clear": ("clear",),
    }
)


def _verb(words: Sequence[str], known: Sequence[str], name: str) -> str:
    """Return the first word, the action; raise `UsageError` if it is not known."""
    verb = words[0].lower() if words else ""
    if verb not in (*known, *_HELP):
        problem = f"{name} has no {words[0]!r}; " if words else ""
        raise UsageError(f"{problem}usage: {name} {'|'.join(known)} …")
    return verb


async def param(session: Session, words: list[str]) -> None:
    """Run an action of `param`: `param show RTL*`, `param set RTL_ALT 3000`."""
    verb = _verb(words, _PARAM, "param")
    rest = words[1:]
    if verb == "fetch" and not rest:
        found = await download_parameters(session.vehicle)
        session.print(f"{len(found)} parameters")
        return
    await run_subcommand(session, "param", [{"show": "list", "fetch": "get"}.get(verb, verb), *rest])


async def wp(session: Session, words: list[str]) -> None:
    """Run an action of `wp`: `wp load FILE`, `wp list`, `wp set 3`."""
    if not words or words[0].lower() == "status":
        _print_progress(session)
        return
    verb = _verb(words, _WP, "wp")
    if verb == "set":
        expect_words(words, 2, 3, "wp set ITEM [reset]")
        reset = [word.lower() for word in words[2:]] == ["reset"]
        item = parse_integer(words[1], "the item", _MAX_ITEM)
        await session.vehicle.mission.set_current(item, restart=reset)
    elif verb == "pause":
        await session.vehicle.mission.pause()
    elif verb == "start":
        await run_subcommand(session, "mission", words)
    else:
        await _plan(session, verb, words[1:], "--mission")


async def fence(session: Session, words: list[str]) -> None:
    """Run an action of `fence`: `fence load FILE`, `fence enable`."""
    verb = _verb(words, _FENCE, "fence")
    if verb in ("enable", "disable"):
        expect_words(words, 1, 1, f"fence {verb}")
        vehicle = session.vehicle
        await vehicle.command(common.MavCmd.DO_FENCE_ENABLE, float(verb == "enable"))
        session.report(f"fence {verb}d")
    else:
        await _plan(session, verb, words[1:], "--fence")


async def rally(session: Session, words: list[str]) -> None:
    """Run an action of `rally`: `rally load FILE`."""
    await _plan(session, _verb(words, tuple(_PLANS), "rally"), words[1:], "--rally")


async def mission(session: Session, words: list[str]) -> None:
    """Run `mission upload flight.plan`: like `mav mission`, with all plans of a file."""
    await run_subcommand(session, "mission", words)


async def ftp(session: Session, words: list[str]) -> None:
    """Run an action of `ftp`: `ftp list /APM`, `ftp get FILE`."""
    verb = _verb(words, (*_FTP, "list", "rmdir"), "ftp")
    rest = words[1:]
    session.completion_cache.clear()
    if verb == "rmdir":
        expect_words(rest, 1, None, "ftp rmdir PATH…")
        for path in rest:
            await session.vehicle.ftp.remove_directory(path.rstrip("/"))
        return
    await run_subcommand(session, "ftp", ["ls" if verb == "list" else verb, *rest])


async def log(session: Session, words: list[str]) -> None:
    """Run `log list`, `log download last` or `log erase`."""
    verb = _verb(words, ("list", "download", "get", "erase"), "log")
    rest = words[1:]
    if verb in ("download", "get"):
        await run_subcommand(session, "log", ["get", *_download_words(rest)])
    elif verb == "erase" and session.interactive and not rest:
        if not await session.confirm(f"erase all logs of vehicle {session.vehicle.system}?"):
            raise CommandError("no log was erased")
        await run_subcommand(session, "log", ["erase", "--yes"])
    else:
        await run_subcommand(session, "log", [verb, *rest])


def _download_words(words: Sequence[str]) -> list[str]:
    """Translate `log download latest` and `log download 3 flight.bin` to the words of `mav log get`."""
    logs = ["last" if word.lower() == "latest" else word for word in words]
    if len(logs) == 2 and not any(word.startswith("-") for word in logs) and not _is_log(logs[1]):
        return [logs[0], "-o", logs[1]]
    return logs


def _is_log(word: str) -> bool:
    return word.lower() in ("last", "all") or word.isdecimal()


async def _plan(session: Session, verb: str, words: Sequence[str], plan_option: str) -> None:
    if verb in _HELP:
        await run_subcommand(session, "mission", [verb])
    else:
        await run_subcommand(session, "mission", [*_PLANS[verb], *words, plan_option])


def _print_progress(session: Session) -> None:
    progress = session.vehicle.mission.progress
    if progress is None:
        raise CommandError(f"vehicle {session.vehicle.system} has not reported its mission progress")
    session.print(f"item {progress.seq} of {progress.total}")


_WP: Final = (*_PLANS, "set", "start", "pause", "status")
_FENCE: Final = (*_PLANS, "enable", "disable")
_PARAM: Final = ("show", "list", "get", "set", "save", "load", "diff", "watch", "fetch")
_parameter_names = completion.by_position(rest=completion.parameters)
_file = completion.by_position(completion.local_files)
_remote = completion.by_position(rest=completion.remote_files)
_plan_words = {**dict.fromkeys(_PLANS), "load": _file, "upload": _file, "save": _file, "download": _file}

COMMANDS: Final = (
    Command(
        "param", "show|set|get|save|load|diff|watch|fetch …", "parameters", param,
        examples=("param show RTL*", "param set RTL_ALT 3000", "param save backup.param", "param fetch"),
        details="The options are those of `mav param`: param load --help shows them. `fetch` without names "
        "downloads all parameters.",
        complete=completion.subcommands(
            {
                **dict.fromkeys(("show", "list", "get", "watch", "fetch"), _parameter_names),
                "set": completion.parameter_assignments,
                **dict.fromkeys(("save", "load", "diff"), _file),
            }
        ),
    ),
    Command(
        "wp", "list|load|save|clear|set|start|pause|status …", "the mission", wp,
        examples=("wp list", "wp save way.txt", "wp set 2", "wp clear"),
        details="wp load way.plan uploads the mission of any file that `mav mission` can read.",
        complete=completion.subcommands({**_plan_words, **dict.fromkeys(_WP[len(_PLANS):])}),
    ),
    Command(
        "fence", "list|load|save|clear|enable|disable …", "the fence", fence,
        examples=("fence list", "fence enable", "fence disable"),
        complete=completion.subcommands({**_plan_words, "enable": None, "disable": None}),
    ),
    Command(
        "rally", "list|load|save|clear …", "rally points", rally, examples=("rally list",),
        complete=completion.subcommands(_plan_words),
    ),
    Command(
        "mission", "upload|download|clear|start|show|convert …", "all plans together, like `mav mission`",
        mission, examples=("mission show", "mission download all.plan"),
        complete=completion.subcommands({**_plan_words, "start": None, "convert": _file}),
    ),
    Command(
        "ftp", "list|get|put|rm|mkdir|rmdir|rename|crc …", "files on the vehicle", ftp,
        examples=("ftp list /", "ftp mkdir /scripts"),
        complete=completion.subcommands(
            {
                **dict.fromkeys(("list", "ls", "rm", "mkdir", "rmdir", "rename", "crc"), _remote),
                "get": completion.by_position(completion.remote_files, completion.local_files),
                "put": completion.by_position(completion.local_files, completion.remote_files),
            }
        ),
    ),
    Command(
        "log", "list|download|erase …", "logs on the vehicle", log,
        examples=("log list", "log erase --yes"),
        details="log download takes numbers, last or all; a file or a directory may follow a number.",
        complete=completion.subcommands(
            {
                "list": None,
                "erase": completion.by_position(completion.choice("--yes")),
                "download": completion.by_position(completion.choice("last", "all"), completion.local_files),
            }
        ),
    ),
)  # fmt: skip
