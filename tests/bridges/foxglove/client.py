"""A client of the Foxglove WebSocket protocol that is not ours: websockets, and CDR by rosbags."""

from __future__ import annotations

import asyncio
import json
import struct
from contextlib import suppress
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed

SUBPROTOCOL = "foxglove.sdk.v1"
_MESSAGE, _RESPONSE = 1, 3
_CLIENT_MESSAGE, _CALL = 1, 2


class FoxgloveClient:
    """The channels, messages and answers that a server sends."""

    def __init__(self, socket: Any) -> None:
        self.socket = socket
        self.channels: dict[str, dict[str, Any]] = {}
        self.services: dict[str, dict[str, Any]] = {}
        self.messages: dict[str, list[tuple[int, bytes]]] = {}
        self.texts: list[dict[str, Any]] = []
        self.responses: dict[int, bytes] = {}
        self._topics: dict[int, str] = {}
        self._task = asyncio.get_running_loop().create_task(self._read())

    async def close(self) -> None:
        self._task.cancel()
        await asyncio.gather(self._task, return_exceptions=True)

    async def subscribe(self, topic: str) -> None:
        number = self.channels[topic]["id"]
        await self.send(op="subscribe", subscriptions=[{"id": number, "channelId": number}])

    async def send(self, **fields: Any) -> None:
        await self.socket.send(json.dumps(fields))

    async def publish(self, number: int, data: bytes) -> None:
        await self.socket.send(struct.pack("<BI", _CLIENT_MESSAGE, number) + data)

    async def call(self, name: str, number: int, data: bytes) -> None:
        encoding = b"cdr"
        head = struct.pack("<BIII", _CALL, self.services[name]["id"], number, len(encoding))
        await self.socket.send(head + encoding + data)

    async def _read(self) -> None:
        # An error that is not retrieved would be logged while garbage is collected, inside of any other code.
        with suppress(ConnectionClosed):
            async for frame in self.socket:
                if isinstance(frame, bytes):
                    self._take(frame)
                else:
                    self._note(json.loads(frame))

    def _note(self, fields: dict[str, Any]) -> None:
        self.texts.append(fields)
        for channel in fields.get("channels", ()) if fields["op"] == "advertise" else ():
            self.channels[channel["topic"]] = channel
            self._topics[channel["id"]] = channel["topic"]
        for service in fields.get("services", ()):
            self.services[service["name"]] = service

    def _take(self, frame: bytes) -> None:
        if frame[0] == _MESSAGE:
            number, time = struct.unpack_from("<IQ", frame, 1)
            self.messages.setdefault(self._topics[number], []).append((time, frame[13:]))
        elif frame[0] == _RESPONSE:
            _, call, size = struct.unpack_from("<III", frame, 1)
            self.responses[call] = frame[13 + size :]


def decoded(channel: dict[str, Any], payload: bytes) -> Any:
    """Decode a message by the schema that the server announced, with rosbags."""
    typesys = pytest.importorskip("rosbags.typesys")
    text, name = channel["schema"], channel["schemaName"]
    store = typesys.get_typestore(typesys.Stores.EMPTY)
    store.register(typesys.get_types_from_msg(text, name))
    return store.deserialize_cdr(payload, name)
