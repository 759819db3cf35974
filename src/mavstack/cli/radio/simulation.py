"""`mav radio sim`: simulated radios and modems on pseudo terminals, until Ctrl-C."""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import echo, echo_json
from mavstack.errors import InvalidArgumentError, LinkURLError
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, open_link
from mavstack.links.impairment_profiles import PROFILES
from mavstack.radio.sbd_simulator import SESSION_TIME

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Coroutine, Sequence

    from mavstack.links import Channel, Link
    from mavstack.links.events import LinkEvent

_SIK, _SBD = "sik", "sbd"
#: Seconds between two checks of the gateway of a simulated satellite modem.
_GATEWAY_INTERVAL: Final = 0.2


def add_simulation_options(parser: ArgumentParser) -> None:
    """Declare the options of `mav radio sim`."""
    profiles = (_SIK, _SBD, *PROFILES)
    parser.add_argument(
        "--profile", choices=profiles, default=_SIK, metavar="NAME",
        help=f"the radios: {', '.join(profiles)} (default: {_SIK}); {_SBD} is an Iridium modem",
    )  # fmt: skip
    parser.add_argument("--near", metavar="PATH", help="other name of the near terminal")
    parser.add_argument("--far", metavar="PATH", help="other name of the far terminal")
    parser.add_argument(
        "--gateway",
        metavar="URL",
        help="link for the messages of an Iridium modem, such as udpout://HOST:PORT",
    )
    parser.add_argument(
        "--session", type=seconds, default=SESSION_TIME, metavar="SECONDS",
        help=f"time of a session of an Iridium modem (default: {SESSION_TIME:g})",
    )  # fmt: skip
    parser.add_argument("--for", dest="seconds", type=seconds, metavar="SECONDS", help="end after this time")
    parser.add_argument("--json", action="store_true", help="print JSON")


async def run_simulation(arguments: Namespace) -> int:
    """Simulate the radios of a profile."""
    if (arguments.gateway is not None) != (arguments.profile == _SBD):
        raise UsageError(f"--gateway and --profile {_SBD} belong together")
    async with AsyncExitStack() as stack:
        if arguments.profile == _SIK:
            names = await _sik(stack, arguments)
        elif arguments.profile == _SBD:
            names = await _sbd(stack, arguments)
        else:
            names = await _modems(stack, arguments)
        if arguments.json:
            echo_json(names)
        else:
            echo(*(f"{end} radio: {name}" for end, name in names.items()), "Ctrl-C to end")
        await asyncio.sleep(arguments.seconds or float("inf"))
    return 0


async def _sik(stack: AsyncExitStack, arguments: Namespace) -> dict[str, str]:
    from mavstack.radio.pseudo_terminals import RadioTerminals

    terminals = await stack.enter_async_context(RadioTerminals())
    names = list(terminals.devices)
    for index, name in enumerate((arguments.near, arguments.far)):
        if name:
            terminals.link(index, name)
            names[index] = name
    return {"near": names[0], "far": names[1]}


async def _sbd(stack: AsyncExitStack, arguments: Namespace) -> dict[str, str]:
    """Simulate an Iridium modem; its gateway is at a link."""
    from mavstack.radio.sbd_terminal import SbdTerminal

    terminal = await stack.enter_async_context(SbdTerminal(session_time=arguments.session))
    if arguments.near:
        terminal.link(arguments.near)
    gateway = _End(_open(arguments.gateway), _delivery(terminal.deliver))
    await gateway.start(stack)

    async def forward() -> None:
        while True:
            await asyncio.sleep(_GATEWAY_INTERVAL)
            while terminal.modem.sent:
                gateway.write(terminal.modem.sent.pop(0))

    _in_background(stack, forward())
    return {"near": arguments.near or terminal.device, "far": gateway.link.url.redacted}


async def _modems(stack: AsyncExitStack, arguments: Namespace) -> dict[str, str]:
    """Join two terminals with the bandwidth, the delay and the loss of a modem."""
    if not (arguments.near and arguments.far):
        raise UsageError(f"--profile {arguments.profile} needs --near and --far")
    near = _open_terminal(arguments.near, f"?impairment={arguments.profile}")
    ends = _End(near), _End(_open_terminal(arguments.far))
    ends[0].receive, ends[1].receive = ends[1].write, ends[0].write
    for each in ends:
        await each.start(stack)
    return {"near": arguments.near, "far": arguments.far}


def _open_terminal(path: str, options: str = "") -> Link:
    return _open(f"pty://{Path(path).absolute()}{options}")


def _open(url: str) -> Link:
    try:
        return open_link(url)
    except LinkURLError as error:
        raise UsageError(str(error)) from None


def _delivery(deliver: Callable[[bytes], None]) -> Callable[[bytes], None]:
    def receive(data: bytes) -> None:
        try:
            deliver(data)
        except InvalidArgumentError as error:
            echo(f"mav radio: {error}", error=True)

    return receive


def _in_background(stack: AsyncExitStack, work: Coroutine[object, object, None]) -> None:
    task = asyncio.get_running_loop().create_task(work)

    async def end() -> None:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task

    stack.push_async_callback(end)


class _End:
    """A link whose bytes go to a function, and to which bytes are written."""

    def __init__(self, link: Link, receive: Callable[[bytes], None] = lambda data: None) -> None:
        self.link, self.receive = link, receive
        self._channels: list[Channel] = []

    async def start(self, stack: AsyncExitStack) -> None:
        await stack.enter_async_context(self.link)
        announce_exposure("radio", [self.link])
        _in_background(stack, self.link.read(self._events))

    def write(self, data: bytes) -> None:
        for channel in self._channels:
            channel.write(data)

    def _events(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case ChannelOpened(channel):
                    self._channels.append(channel)
                case ChannelClosed(channel):
                    self._channels.remove(channel)
                case BytesReceived(data=data):
                    self.receive(data)
