"""`mav route ctl`: control of a running router."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.output import echo, echo_json, table_lines
from mavstack.cli.common.text import size_text
from mavstack.router.config.model import DEFAULT_CONTROL
from mavstack.router.control.client import ControlClient

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Sequence

#: The environment variable with the token of the control API.
TOKEN_VARIABLE: Final = "MAVSTACK_CONTROL_TOKEN"  # noqa: S105 (the name of a variable)
_ACTIONS: Final = ("list", "stats", "routes", "add", "set", "remove", "pause", "resume", "reload")
_WITH_NAME: Final = ("add", "set", "remove", "pause", "resume")


def control(words: Sequence[str], arguments: Namespace) -> int:
    """Run one action on a running router."""
    if not words or words[0] not in _ACTIONS:
        raise UsageError(f"ctl needs an action: {', '.join(_ACTIONS)}")
    action, *rest = words
    if action in _WITH_NAME and not rest:
        raise UsageError(f"ctl {action} needs the name of an endpoint")
    token = read_token(arguments.token_file) or os.environ.get(TOKEN_VARIABLE, "")
    client = ControlClient(arguments.control or DEFAULT_CONTROL, token=token)
    if action in ("list", "stats", "routes"):
        _show(client, action, as_json=arguments.json)
        return 0
    notes = _act(client, action, rest)
    if arguments.json:
        echo_json({"notes": notes})
        return 0
    for note in notes:
        echo(f"mav route: {note}", error=True)
    return 0


def read_token(path: str | None) -> str:
    """Return the token in a file; empty without a file."""
    if path is None:
        return ""
    try:
        token = Path(path).read_text("utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise CommandError(f"cannot open {path}: {getattr(error, 'strerror', None) or error}") from None
    if not token or not token.isascii() or not token.isprintable():
        raise CommandError(f"{path}: the token must be one line of ASCII")
    return token


def _act(client: ControlClient, action: str, rest: Sequence[str]) -> list[str]:
    """Make a change, and return notes about what could not be done."""
    if action == "reload":
        return client.reload()
    name, *values = rest
    if action in ("remove", "pause", "resume") and values:
        raise UsageError(f"ctl {action} needs one name, got {' '.join(rest)}")
    match action:
        case "add":
            if not values or "://" not in values[0]:
                raise UsageError("ctl add needs a name and a URL: ctl add tablet udpout://192.168.1.20:14550")
            client.add(name, {"url": values[0], **_settings(values[1:])})
        case "set":
            client.change(name, _settings(values))
        case "remove":
            client.remove(name)
        case _:
            client.pause(name, paused=action == "pause")
    return []


def _settings(words: Sequence[str]) -> dict[str, Any]:
    """Return settings of the form KEY=VALUE; a value is TOML, or else a text."""
    settings: dict[str, Any] = {}
    for word in words:
        key, equals, text = word.partition("=")
        if not (key and equals):
            raise UsageError(f"{word!r} is not a setting of the form KEY=VALUE")
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            value = text
        table = settings
        *tables, last = key.split(".")
        for each in tables:
            table = table.setdefault(each, {})
        table[last] = value
    return settings


def _show(client: ControlClient, action: str, *, as_json: bool) -> None:
    found = client.routes() if action == "routes" else client.endpoints()
    if as_json:
        echo_json(found)
        return
    lines = {"list": _list_lines, "stats": _statistics_lines, "routes": _route_lines}[action](found)
    echo(*lines)


def _list_lines(endpoints: Sequence[dict[str, Any]]) -> list[str]:
    rows = [
        [each["name"], each["state"], each["url"], str(len(each["links"])), ", ".join(_remarks(each))]
        for each in endpoints
    ]
    head = ("ENDPOINT", "STATE", "URL", "LINKS", "")
    return list(table_lines(head, rows, ("ENDPOINT", "STATE", "URL", "")))


def _remarks(endpoint: dict[str, Any]) -> list[str]:
    marks = [word for word in ("pause", "listen_only") if endpoint[word]]
    group = [f"group {endpoint['group']}"] if endpoint["group"] else []
    return [*marks, *group, *([endpoint["reason"]] if endpoint["reason"] else [])]


def _statistics_lines(endpoints: Sequence[dict[str, Any]]) -> list[str]:
    rows = [
        [
            each["name"],
            str(each["received"]),
            size_text(each["received_bytes"]),
            str(each["sent"]),
            size_text(each["sent_bytes"]),
            str(each["lost"]),
            str(each["bad_crc"]),
            ", ".join(f"{cause} {count}" for cause, count in sorted(each["dropped"].items())),
        ]
        for each in endpoints
    ]
    head = ("ENDPOINT", "RECEIVED", "", "SENT", "", "LOST", "BAD CRC", "DROPPED")
    return list(table_lines(head, rows, ("ENDPOINT", "DROPPED")))


def _route_lines(routes: Sequence[dict[str, Any]]) -> list[str]:
    rows = [
        [f"{each['system']}/{each['component']}", ", ".join(each["endpoints"]), f"{each['age']:.1f} s"]
        for each in routes
    ]
    return list(table_lines(("ADDRESS", "ENDPOINTS", "HEARD"), rows, ("ADDRESS", "ENDPOINTS")))
