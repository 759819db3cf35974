"""Findings about a server of Foxglove: its channels, their definitions, and what clients may do."""

from __future__ import annotations

import asyncio
import json
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.finding import Finding
from mavstack.bridges.core.types import message_text
from mavstack.errors import InvalidArgumentError, LinkError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

#: Seconds in which a server must send its channels.
ANSWER_TIMEOUT: Final = 2.0
_OPEN_TIMEOUT: Final = 5.0
#: Maximum size of a message in bytes.
_MAX_FRAME: Final = 32 << 20
_SUBPROTOCOL: Final = "foxglove.sdk.v1"
_ENCODING: Final = "ros2msg"


async def check_server(url: str) -> list[Finding]:
    """Return the findings about a server.

    Args:
        url: The server, such as "ws://127.0.0.1:8765".

    Raises:
        LinkError: No server of Foxglove answers there.
        MissingExtraError: websockets is not installed.
    """
    try:
        from websockets.asyncio.client import connect
        from websockets.exceptions import WebSocketException
        from websockets.typing import Subprotocol
    except ImportError:
        raise MissingExtraError("the check of a Foxglove server", "web") from None
    texts: list[dict[str, Any]] = []
    options: dict[str, Any] = {"max_size": _MAX_FRAME, "open_timeout": _OPEN_TIMEOUT, "proxy": None}
    try:
        async with connect(url, subprotocols=[Subprotocol(_SUBPROTOCOL)], **options) as socket:
            with suppress(TimeoutError):
                async with asyncio.timeout(ANSWER_TIMEOUT):
                    async for frame in socket:
                        _take(frame, texts)
    except (OSError, ValueError, RecursionError, WebSocketException) as error:
        reason = getattr(error, "strerror", None) or error
        raise LinkError(
            f"connecting to the Foxglove server {url} failed: {reason}; is `mav bridge foxglove` running? "
            "--port names another port"
        ) from None
    return list(describe(url, texts))


def describe(url: str, texts: Sequence[dict[str, Any]]) -> Iterator[Finding]:
    """Yield the findings about the messages of a server.

    Args:
        url: The server.
        texts: Its messages of text, parsed.
    """
    info = next((each for each in texts if each.get("op") == "serverInfo"), None)
    if info is None:
        yield Finding(False, f"{url} does not present itself as a server of Foxglove")
        return
    channels = [
        channel for each in texts for channel in _list_of(each, "channels") if isinstance(channel, dict)
    ]
    services = [service for each in texts for service in _list_of(each, "services")]
    text = f"{url} is {info.get('name')}, with {len(channels)} channels and {len(services)} services"
    yield Finding(True, text)
    yield Finding(True, "a server of Foxglove does not tell its clients about each other")
    if not channels:
        yield Finding(False, "there are no channels: has the bridge found a vehicle?")
    yield from (finding for channel in channels if (finding := _of_channel(channel)) is not None)
    allowed = "clientPublish" in _list_of(info, "capabilities")
    note = "clients may publish" if allowed else "clients only observe: the bridge has no --allow-control"
    yield Finding(True, note)


def _take(frame: str | bytes, texts: list[dict[str, Any]]) -> None:
    if isinstance(frame, str) and isinstance(found := json.loads(frame), dict):
        texts.append(found)


def _list_of(message: dict[str, Any], key: str) -> list[Any]:
    found = message.get(key)
    return found if isinstance(found, list) else []


def _of_channel(channel: dict[str, Any]) -> Finding | None:
    """Return a finding about a channel whose definition is not ours; None: it is, or is not of ROS 2."""
    name, topic = str(channel.get("schemaName")), str(channel.get("topic"))
    if channel.get("schemaEncoding") != _ENCODING:
        return None
    try:
        own = message_text(name)
    except (InvalidArgumentError, KeyError):
        return Finding(False, f"{topic} has the type {name}, which this version does not know", topic)
    if channel.get("schema") == own:
        return None
    return Finding(
        False, f"{topic} has another definition of {name}: the bridge is of another version", topic
    )
