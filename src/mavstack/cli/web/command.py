"""`mav web`: the ground station in the browser, with an HTTP and WebSocket API."""

from __future__ import annotations

import asyncio
import sys
from socket import gethostname
from typing import TYPE_CHECKING, Any, Final

from mavstack.cli.common.collection import no_collection
from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.link_options import add_link_options, with_link_options
from mavstack.cli.common.output import echo, echo_json
from mavstack.cli.web.passwords import read_passwords
from mavstack.errors import InvalidArgumentError
from mavstack.http.web_origin import is_loopback

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.router.control.client import ControlClient
    from mavstack.server.access import Access

EXAMPLES: Final = """\
examples:
  mav web udpin://0.0.0.0:14550            # vehicles on UDP; the browser opens by itself
  mav web /dev/ttyACM0,57600 --no-browser --port 8080
  mav web msp+serial:///dev/ttyACM0        # Betaflight or iNav
  mav web 'csv+tcp://127.0.0.1:5770?name=cansat&template=time:s,alt:m'   # lines of values
  mav web                                  # sources are added on the page
  mav web udpin://0.0.0.0:14550 --host 0.0.0.0 --password passwords.txt --certificate server.pem

The station serves this machine alone. With --host other machines reach it, and need a password or a ticket;
each line of the file of passwords has a role (observe, operate, administer) and its password. The API is
described at /openapi.json. Ctrl-C ends the station.
"""
MAX_PORT: Final = 65535


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    add = parser.add_argument
    add(
        "urls", nargs="*", metavar="URL", help="source to open, such as udpin://0.0.0.0:14550; one or several"
    )
    add(
        "--port",
        type=int,
        default=8080,
        metavar="N",
        help="port of the station; 0: a free one (default: 8080)",
    )
    add("--host", default="127.0.0.1", metavar="ADDRESS", help="address to listen on (default: 127.0.0.1)")
    add("--no-browser", action="store_true", help="do not open the browser")
    add("--folder", default="recordings", metavar="DIRECTORY", help="recordings (default: ./recordings)")
    add("--maps", metavar="DIRECTORY", help="maps for places without network (default: those of mav map)")
    add(
        "--program",
        action="append",
        default=[],
        metavar="NAME=PATH",
        help="a firmware program that administrators may start in simulated worlds; may be repeated",
    )
    add("--router", metavar="HOST:PORT", help="show the router of Mavstack whose control API is there")
    add("--router-token", metavar="FILE", help="file with the token of that router")
    add("--json", action="store_true", help="print the address as one JSON object")
    access = parser.add_argument_group("access")
    access.add_argument(
        "--password", metavar="FILE", help="passwords: one, or a role and a password per line"
    )
    access.add_argument(
        "--tickets", metavar="KEY", help="take tickets of this API key: a file or a key's name"
    )
    access.add_argument("--certificate", metavar="FILE", help="serve HTTPS with this certificate (PEM)")
    access.add_argument("--certificate-key", metavar="FILE", help="its private key, if it is in another file")
    access.add_argument(
        "--origin", action="append", default=[], metavar="URL", help="let pages of this site use the API"
    )
    access.add_argument(
        "--proxy", default="", metavar="ADDRESS", help="a proxy there names the clients (X-Forwarded-For)"
    )
    add_link_options(parser.add_argument_group("links"))


def run(arguments: Namespace) -> int:
    """Run `mav web`."""
    if not 0 <= arguments.port <= MAX_PORT:
        raise UsageError(f"--port must be from 0 to {MAX_PORT}, got {arguments.port}")
    if arguments.certificate_key and not arguments.certificate:
        raise UsageError("--certificate-key needs --certificate")
    return run_until_signal(_serve(arguments))


async def _serve(arguments: Namespace) -> int:
    with no_collection():  # garbage collection would take a sixth of the import time, and later delay packets
        from mavstack.http.server import Certificate, serving
        from mavstack.maps.folder import default_folder
        from mavstack.server.app import make_app, make_early_answers
        from mavstack.server.rows.urls import is_row_url
        from mavstack.server.station import Station
        from mavstack.vehicle import Connection

    access = _access(arguments)
    rows = [url for url in arguments.urls if is_row_url(url)]
    links = [url for url in arguments.urls if not is_row_url(url)]
    connection = Connection(*with_link_options(links, arguments))
    station = Station(
        connection,
        folder=arguments.folder,
        network_only=access.is_open,
        router=_router(arguments),
        programs=dict(map(_program, arguments.program)),
        maps=arguments.maps or default_folder(),
    )
    certificate = arguments.certificate
    tls = Certificate(certificate, arguments.certificate_key) if certificate else None
    host = f"[{arguments.host}]" if ":" in arguments.host else arguments.host
    async with station:
        for url in rows:
            await station.sources.add(url)
        announce_exposure("web", connection.links)
        app = make_app(station, access, secure=tls is not None)
        listening = serving(
            app,
            f"{host}:{arguments.port}",
            name="the ground station",
            tls=tls,
            websockets=True,
            proxy=arguments.proxy,
            comes_first=access.comes_first,
            answer_early=make_early_answers(station, access),
        )
        async with listening as (_, port):
            _announce(arguments, port, secure=tls is not None)
            await connection.serve_forever()
    return 0


def _program(text: str) -> tuple[str, str]:
    name, separator, path = text.partition("=")
    if not (name and separator and path):
        raise UsageError(f"--program {text!r} is not NAME=PATH")
    return name, path


def _access(arguments: Namespace) -> Access:
    from mavstack.security.api_keys import read_api_key
    from mavstack.server.access import Access

    passwords = read_passwords(arguments.password) if arguments.password else {}
    ticket_key = read_api_key(arguments.tickets) if arguments.tickets else ""
    local = is_loopback(arguments.host)
    if not (local or passwords or ticket_key):
        raise UsageError(
            f"--host {arguments.host} is reachable from other machines: give --password or --tickets too"
        )
    try:
        return Access(passwords=passwords, ticket_key=ticket_key, local=local, origins=arguments.origin)
    except InvalidArgumentError as error:
        raise CommandError(f"{arguments.password}: {error}") from None


def _router(arguments: Namespace) -> ControlClient | None:
    if arguments.router is None:
        return None
    from mavstack.cli.route.control import read_token
    from mavstack.router.control.client import ControlClient

    return ControlClient(arguments.router, token=read_token(arguments.router_token))


def _announce(arguments: Namespace, port: int, *, secure: bool) -> None:
    from mavstack.server.app import NOT_BUILT, STATIC

    local = is_loopback(arguments.host)
    host = arguments.host if local else "localhost"
    host = f"[{host}]" if ":" in host else host
    url = f"{'https' if secure else 'http'}://{host}:{port}/"
    if arguments.json:
        values: dict[str, Any] = {"url": url, "host": arguments.host, "port": port}
        echo_json(values)
    else:
        echo(f"ground station on {url}; Ctrl-C to end")
        if not local:
            name = gethostname()
            echo(f"other machines: {url.replace('localhost', name)}, with a password or a ticket")
        if not (STATIC / "index.html").is_file():
            echo(f"mav web: {NOT_BUILT}".rstrip(), error=True)
    if not local and not secure:
        echo("mav web: passwords travel in clear text over the network: give --certificate", error=True)
    if not arguments.no_browser and sys.stdout.isatty():
        _open_browser(url)


def _open_browser(url: str) -> None:
    import webbrowser

    # A browser inside the terminal would block the event loop, so it is started in a thread.
    asyncio.get_running_loop().run_in_executor(None, webbrowser.open, url)
