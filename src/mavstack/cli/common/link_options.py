"""The options of every command that opens a link: `--key`, `--id`, `--mavlink`, `--heartbeat-rate`.

They are the options `signing_key`, `id`, `mavlink` and `heartbeat_rate` of a link URL, for all links of the
command. A URL that has one of them itself keeps its own.
"""

from __future__ import annotations

from argparse import ArgumentTypeError
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, TypeVar

from mavstack.links.settings import ADDRESS_FORMAT, RATE_FORMAT, VERSIONS, parse_address, parse_heartbeat_rate

if TYPE_CHECKING:
    from argparse import Namespace, _ActionsContainer
    from collections.abc import Callable, Sequence

Value = TypeVar("Value")

#: Command-line options that set the URL option of the same name.
_URL_OPTIONS: Final = ("signing_key", "id", "mavlink", "heartbeat_rate")


def add_link_options(group: _ActionsContainer, *, identity: bool = True, key: bool = True) -> None:
    """Declare the options of links.

    Args:
        group: Group of arguments of the command or action.
        identity: The command is a component of its own, with `--id` and `--heartbeat-rate`; simulated
            vehicles have ids of their own.
        key: The command takes the present key with `--key`.
    """
    add = group.add_argument
    if key:
        add_key_option(group, "sign with this key, and accept only packets signed with it")
    add(
        "--mavlink",
        choices=tuple(VERSIONS),
        help="MAVLink version to send; auto: 1 to peers heard only in version 1 (default: 2)",
    )
    if identity:
        add(
            "--id",
            type=_checked(parse_address, ADDRESS_FORMAT),
            metavar="SYSTEM[/COMPONENT]",
            help="our own ids (default: 255/190)",
        )
        add(
            "--heartbeat-rate",
            type=_checked(parse_heartbeat_rate, RATE_FORMAT),
            metavar="HZ",
            help="our heartbeats per second; 0: none (default: 1)",
        )


def add_key_option(group: _ActionsContainer, summary: str) -> None:
    """Declare `--key`.

    Args:
        group: Group of arguments of the command or action.
        summary: The text of its help.
    """
    group.add_argument("--key", dest="signing_key", metavar="FILE|NAME", help=summary)


def with_link_options(urls: Sequence[str], arguments: Namespace) -> list[str]:
    """Return the URLs of links with the options of the command line added.

    Raises:
        LinkURLError: A URL is not valid.
    """
    named = ((name, getattr(arguments, name, None)) for name in _URL_OPTIONS)
    given = {name: value for name, value in named if value is not None}
    return [_with_options(url, given) for url in urls] if given else list(urls)


def _with_options(url: str, given: dict[str, str]) -> str:
    from mavstack.links.registry import resolve_url

    parsed = resolve_url(url)
    return str(replace(parsed, options={**given, **parsed.options}))


def _checked(parse: Callable[[str], Any], expected: str) -> Callable[[str], str]:
    """Return a type for argparse that checks a text and keeps it."""

    def check(text: str) -> str:
        try:
            parse(text)
        except ValueError:
            raise ArgumentTypeError(f"{text!r} is not {expected}") from None
        return text

    return check
