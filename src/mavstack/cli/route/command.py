"""`mav route`: join links, from a configuration file or from URLs; check a file; control a running router."""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.link_options import add_key_option, with_link_options
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import echo, echo_text
from mavstack.cli.route.running import run_router
from mavstack.links.registry import open_link, resolve_url
from mavstack.router.config import (
    EndpointConfig,
    Recording,
    RouterConfig,
    check_control,
    check_link_settings,
    load_config,
    toml_text,
)
from mavstack.router.guard import check_firewall

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable

EXAMPLES: Final = """\
examples:
  mav route -e /dev/ttyACM0,921600 -e udpin://0.0.0.0:14550    # a serial autopilot for ground stations
  mav route -e udpin://0.0.0.0:14550 -e tcpin://127.0.0.1:5760 -e wsin://127.0.0.1:5770
  mav route --key field -e /dev/ttyACM0 -e udpin://0.0.0.0:14550   # only packets signed with the key field
  mav route router.toml                                        # endpoints, filters, rates, recorder
  mav route check router.toml
  mav route learn flight.tlog -o rules.toml                    # a firewall that allows this flight
  mav route --from /etc/mavlink-router/main.conf               # a file of mavlink-router, as it is
  mav route --from /etc/mavlink-router/main.conf --print > router.toml
  mav route ctl list                                           # a router with control = true
  mav route ctl add tablet udpout://192.168.1.20:14550 listen_only=true
  mav route ctl pause tablet

The router runs until Ctrl-C or SIGTERM. SIGHUP, a change of the file and `mav route ctl reload` load the file
again; links that did not change lose nothing. A terminal shows the traffic; --json prints it as
one object per second.

actions of ctl: list, stats, routes, add NAME URL [KEY=VALUE …], set NAME KEY=VALUE …, remove NAME,
pause NAME, resume NAME, reload
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    add = parser.add_argument
    add(
        "words",
        nargs="*",
        metavar="CONFIG",
        help="configuration file; or: check CONFIG; learn LOG; ctl ACTION …",
    )
    add("-e", "--endpoint", action="append", default=[], metavar="URL", help="link to join; may be repeated")
    add_key_option(parser, "verify packets of the links of -e with this key, and sign packets to them")
    add("--from", dest="foreign", metavar="FILE", help="run with a configuration file of mavlink-router")
    add("--print", dest="prints", action="store_true", help="print the configuration as TOML, and end")
    add("--duplicate-window", type=seconds, metavar="SECONDS", help="drop equal packets within this time")
    add("-o", "--output", metavar="FILE", help="of learn: file to write (default: stdout)")
    add("--record", metavar="FILE", help="record all forwarded packets to a tlog or .pcap")
    add("--control", metavar="HOST:PORT", help="control API: serve it here; of ctl: reach it here")
    add("--token-file", metavar="FILE", help="file with the token of the control API")
    add("--once", action="store_true", help="no live picture")
    add("--json", action="store_true", help="print the state as JSON: every second, or the answer of ctl")
    parser.set_defaults(command="route")


def run(arguments: Namespace) -> int:
    """Run `mav route`."""
    words = arguments.words
    # The modules of the other actions are imported only for them, so that a router starts quickly.
    if words[:1] == ["ctl"]:
        from mavstack.cli.route.control import control

        return control(words[1:], arguments)
    if words[:1] == ["learn"]:
        from mavstack.cli.route.learn import learn

        return learn(words[1:], arguments)
    if words[:1] == ["check"]:
        return _check(words[1:])
    config, load = _config(arguments)
    if arguments.prints:
        if config.firewall is not None:
            raise UsageError(f"--print cannot write [firewall]: copy it from {words[0]}")
        echo_text(toml_text(config))
        return 0
    if not config.endpoints:
        raise UsageError("there is no endpoint: give two links (-e URL -e URL), or a configuration file")
    return run_until_signal(run_router(config, arguments, words[0] if words else "", load))


def _check(words: list[str]) -> int:
    if len(words) != 1:
        raise UsageError("check needs one configuration file")
    config = load_config(words[0])
    check_firewall(config)
    number = len(config.endpoints)
    echo(f"{words[0]}: valid, {number} endpoint{'' if number == 1 else 's'}")
    return 0


def _config(arguments: Namespace) -> tuple[RouterConfig, Callable[[str], RouterConfig]]:
    """Return the configuration of the command line, and what loads its file again."""
    words = arguments.words
    if len(words) > 1:
        raise UsageError(f"one configuration file is needed, got {' '.join(words)}; links are given with -e")
    if words and arguments.foreign:
        raise UsageError("give either a configuration file or --from")
    if words and "://" in words[0]:
        raise UsageError(f"{words[0]} is a link: give links with -e")

    def load(path: str) -> RouterConfig:
        return _with_options(load_config(path), arguments)

    if words:
        return load(words[0]), load
    if arguments.foreign:
        from mavstack.router.mavlink_router_config import read_mavlink_router_config

        converted = read_mavlink_router_config(arguments.foreign)
        for note in converted.notes:
            echo(f"mav route: {note}", error=True)
        return _with_options(converted.config, arguments), load
    return _with_options(RouterConfig(), arguments), load


def _with_options(config: RouterConfig, arguments: Namespace) -> RouterConfig:
    """Return a configuration with the endpoints and the settings of the command line added."""
    endpoints = list(config.endpoints)
    for text in with_link_options(arguments.endpoint, arguments):
        url = resolve_url(text)
        check_link_settings(open_link(url))  # raises if the URL has an unknown option
        endpoints.append(EndpointConfig(_free_name(url.scheme, endpoints), str(url)))
    if arguments.record:
        endpoints.append(
            EndpointConfig(_free_name("recorder", endpoints), record=Recording(arguments.record))
        )
    token = _token(arguments.token_file) or config.control_token
    control = arguments.control or config.control
    try:
        check_control(control, token)
    except ValueError as error:
        raise UsageError(f"--control must be {error}") from None
    window = config.duplicate_window if arguments.duplicate_window is None else arguments.duplicate_window
    return replace(
        config, endpoints=tuple(endpoints), control=control, control_token=token, duplicate_window=window
    )


def _token(path: str | None) -> str:
    if path is None:
        return ""
    from mavstack.cli.route.control import read_token

    return read_token(path)


def _free_name(word: str, endpoints: list[EndpointConfig]) -> str:
    taken = {each.name for each in endpoints}
    names = (f"{word}{number}" if number > 1 else word for number in count(1))
    return next(name for name in names if name not in taken)
