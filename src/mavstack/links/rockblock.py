"""RockBLOCK modems by their gateway: `rockblock://0.0.0.0:8080/hook?imei=300234010753370&account=account.txt`.

The link is the web hook of the gateway, and sends messages to the modem over the web interface of the
gateway. `account` is a file with the name and the password of the account, one a line; without it nothing can
be sent. Put the link behind a proxy with TLS, and make the path a secret, since every program that knows it
can deliver messages; with `imei` only those of one modem count. Each message costs: set `heartbeat_rate=0`,
unless a router owns the link, which sends no heartbeats.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from hmac import compare_digest
from http import HTTPStatus
from pathlib import Path
from time import time
from typing import TYPE_CHECKING, Final, cast
from urllib.error import URLError
from urllib.request import Request, urlopen

from mavstack.handshakes import Handshakes
from mavstack.links.base import Link
from mavstack.links.channel import Channel
from mavstack.links.os_errors import open_error
from mavstack.links.rockblock_api import GATEWAY, MAX_BODY, Delivered, failure_of, message_form, parse_hook
from mavstack.links.sbd_modem import MAX_RECEIVED

if TYPE_CHECKING:
    from mavstack.links.channel import Data
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

#: Timeouts of requests from and to the gateway in seconds; maximum numbers of modems and waiting requests.
HOOK_TIMEOUT: Final = 5.0
SEND_TIMEOUT: Final = 20.0
MAX_MODEMS: Final = 64
MAX_WAITING: Final = 4
_MAX_HEAD: Final = 8192
_LOGGER: Final = logging.getLogger("mavstack.links")


class RockblockChannel(Channel):
    """One modem behind the gateway."""

    def __init__(self, link: RockblockLink, imei: str) -> None:
        super().__init__(f"rockblock {imei}", imei, link.inbox.remove_channel)
        self._link = link
        self._waiting = 0

    def send_bytes(self, data: Data) -> bool:
        """Send a message; too large ones and those beyond the queue are dropped."""
        if len(data) > MAX_RECEIVED or self._waiting >= MAX_WAITING or not self._link.can_send:
            return False
        self._waiting += 1
        self._link.spawn(self._post(bytes(data)))
        return True

    async def drain(self) -> None:
        """Return at once: packets beyond the queue are dropped."""

    def close_transport(self) -> None:
        """Do nothing: the gateway has no connection."""

    async def _post(self, data: bytes) -> None:
        try:
            failure = await asyncio.to_thread(self._link.post, self.peer, data)
        except (URLError, OSError, ValueError) as error:
            failure = str(error)
        finally:
            self._waiting -= 1
        if failure:
            _LOGGER.warning("%s: the gateway refused a message: %s", self.name, failure)


class RockblockLink(Link):
    """The web hook, and a channel for each modem that sent a message."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._imei = options.text("imei", "")
        self._gateway = options.text("gateway", GATEWAY)
        self._account = options.parsed("account", _read_account, "a file of two lines: name and password")
        self._handshakes = Handshakes()
        self._path = url.path or "/"
        self._delivered = Delivered()
        self._server: asyncio.Server | None = None
        self._modems: dict[str, RockblockChannel] = {}

    @property
    def can_send(self) -> bool:
        """True if the account is known."""
        return self._account is not None

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port of the web hook."""
        if self._server is None or not self._server.sockets:
            return None
        host, port = self._server.sockets[0].getsockname()[:2]
        return host, port

    async def open_transport(self) -> None:
        """Listen for the gateway; a modem that the URL names has its channel at once."""
        try:
            self._server = await asyncio.start_server(
                self._serve, self.url.host, self.url.port, limit=_MAX_HEAD
            )
        except OSError as error:
            raise open_error(self.url, error) from error
        if self._imei:
            self._channel(self._imei)

    async def stop_transport(self) -> None:
        """Stop listening."""
        self._handshakes.close()
        if self._server is not None:
            self._server.close()

    def post(self, imei: str, data: bytes) -> str:
        """Send a message to a modem, in a thread; return why the gateway refused it, or an empty text."""
        if self._account is None:
            return "the link has no account"
        name, password = self._account
        request = Request(self._gateway, message_form(imei, name, password, data))  # noqa: S310 (configured)
        with urlopen(request, timeout=SEND_TIMEOUT) as answer:  # noqa: S310 (a configured gateway)
            return failure_of(answer.read(_MAX_HEAD))

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        transport = cast("asyncio.Transport", writer.transport)
        # limit the connections of strangers: any host can connect to the hook
        self._handshakes.begin(transport)
        status = HTTPStatus.BAD_REQUEST
        try:
            async with asyncio.timeout(HOOK_TIMEOUT):
                status = await self._answer(reader)
        except (OSError, ValueError, asyncio.IncompleteReadError, asyncio.LimitOverrunError, TimeoutError):
            pass  # a malformed or unfinished request
        finally:
            self._handshakes.end(transport)
        head = f"HTTP/1.1 {status.value} {status.phrase}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
        with suppress(OSError):
            writer.write(head.encode())
            await writer.drain()
            writer.close()

    async def _answer(self, reader: asyncio.StreamReader) -> HTTPStatus:
        head = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1").split("\r\n")
        method, path, _ = head[0].split(" ", 2)
        fields = {
            name.strip().lower(): value.strip()
            for name, _, value in (line.partition(":") for line in head[1:])
        }
        if not compare_digest(path.partition("?")[0].encode("latin-1"), self._path.encode()):
            return HTTPStatus.NOT_FOUND
        size = int(fields.get("content-length", "0"))
        if method != "POST" or not 0 < size <= MAX_BODY:
            return HTTPStatus.BAD_REQUEST
        return self._deliver(await reader.readexactly(size))

    def _deliver(self, body: bytes) -> HTTPStatus:
        hook = parse_hook(body)
        if hook is None:
            return HTTPStatus.BAD_REQUEST
        channel = self._channel(hook.imei) if hook.imei == (self._imei or hook.imei) else None
        if channel is None:
            return HTTPStatus.FORBIDDEN
        if hook.data and self._delivered.is_new(hook):
            self.inbox.offer(channel, hook.data, time())
        return HTTPStatus.OK

    def _channel(self, imei: str) -> RockblockChannel | None:
        if imei not in self._modems and len(self._modems) < MAX_MODEMS and not self.closed:
            self._modems[imei] = channel = RockblockChannel(self, imei)
            self.inbox.add_channel(channel)
        return self._modems.get(imei)


def _read_account(path: str) -> tuple[str, str]:
    try:
        name, password = Path(path).read_text("utf-8").split("\n")[:2]
    except OSError as error:
        raise ValueError(error) from None
    if not (name.strip() and password.strip()):
        raise ValueError("empty")
    return name.strip(), password.strip()
