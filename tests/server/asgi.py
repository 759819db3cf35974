"""Clients of an ASGI application in the event loop of a test, also in virtual time."""

from __future__ import annotations

import asyncio
import json
from dataclasses import dataclass, field
from typing import Any, Self
from urllib.parse import unquote, urlsplit

HOST = "127.0.0.1:8080"


@dataclass
class Answer:
    """An answer to a request."""

    status: int = 0
    headers: dict[str, str] = field(default_factory=dict)
    data: bytes = b""

    @property
    def json(self) -> Any:
        return json.loads(self.data)

    @property
    def problem(self) -> str:
        return self.json["error"]["text"]

    @property
    def kind(self) -> str:
        return self.json["error"]["kind"]


@dataclass
class ApiClient:
    """A client that calls an application."""

    app: Any
    host: str = HOST
    headers: dict[str, str] = field(default_factory=dict)
    address: str = "127.0.0.1"

    async def get(self, path: str, **options: Any) -> Answer:
        return await self.request("GET", path, **options)

    async def post(self, path: str, body: Any = None, **options: Any) -> Answer:
        return await self.request("POST", path, body, **options)

    async def put(self, path: str, body: Any = None, **options: Any) -> Answer:
        return await self.request("PUT", path, body, **options)

    async def delete(self, path: str, **options: Any) -> Answer:
        return await self.request("DELETE", path, **options)

    async def request(
        self,
        method: str,
        path: str,
        body: Any = None,
        *,
        data: bytes = b"",
        headers: Any = None,
        leave: asyncio.Event | None = None,
    ) -> Answer:
        """Send a request; `body` is sent as JSON. The client leaves when the event `leave` is set."""
        sent = {"host": self.host, **self.headers, **(headers or {})}
        if body is not None:
            data = json.dumps(body).encode()
            sent.setdefault("content-type", "application/json")
        if data:
            sent["content-length"] = str(len(data))
        answer = Answer()
        requests = [{"type": "http.request", "body": data, "more_body": False}]

        async def receive() -> dict[str, Any]:
            if requests:
                return requests.pop()
            await (leave or asyncio.Event()).wait()
            return {"type": "http.disconnect"}

        async def send(message: dict[str, Any]) -> None:
            if message["type"] == "http.response.start":
                answer.status = message["status"]
                answer.headers = {name.decode(): value.decode() for name, value in message["headers"]}
            else:
                answer.data += message.get("body", b"")

        await self.app(self._scope("http", method, path, sent), receive, send)
        return answer

    def websocket(self, *subprotocols: str, headers: Any = None) -> SocketClient:
        """Return a WebSocket, which `async with` opens."""
        sent = {"host": self.host, **self.headers, **(headers or {})}
        if subprotocols:
            sent["sec-websocket-protocol"] = ", ".join(subprotocols)
        scope = self._scope("websocket", "GET", "/ws", sent) | {
            "subprotocols": list(subprotocols),
            "extensions": {"websocket.http.response": {}},
        }
        return SocketClient(self.app, scope)

    def _scope(self, kind: str, method: str, path: str, headers: dict[str, str]) -> dict[str, Any]:
        parts = urlsplit(path)
        return {
            "type": kind,
            "asgi": {"version": "3.0"},
            "http_version": "1.1",
            "method": method,
            "scheme": "http" if kind == "http" else "ws",
            "path": unquote(parts.path),
            "raw_path": parts.path.encode(),
            "query_string": parts.query.encode(),
            "root_path": "",
            "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
            "client": (self.address, 50000),
            "server": ("127.0.0.1", 8080),
        }


class RefusedSocketError(Exception):
    """The server refused a WebSocket, with the status."""


class SocketClient:
    """A WebSocket; `slow` stops reading what the server sends."""

    def __init__(self, app: Any, scope: dict[str, Any]) -> None:
        self._app, self._scope = app, scope
        self._to_server: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        self._to_client: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        self._may_send = asyncio.Event()
        self._may_send.set()
        self.subprotocol: str | None = None
        self.task: asyncio.Task[None] | None = None

    def pause(self) -> None:
        self._may_send.clear()

    def resume(self) -> None:
        self._may_send.set()

    def clear(self) -> None:
        """Drop what was received."""
        while not self._to_client.empty():
            self._to_client.get_nowait()

    async def send(self, data: Any) -> None:
        """Send bytes, a text, or a value as JSON."""
        key = "bytes" if isinstance(data, bytes) else "text"
        text = data if isinstance(data, bytes | str) else json.dumps(data)
        await self._to_server.put({"type": "websocket.receive", key: text})

    async def receive(self, timeout: float = 10.0) -> Any:
        """Return the next bytes, or the JSON of the next text."""
        async with asyncio.timeout(timeout):
            message = await self._to_client.get()
        found = message.get("bytes")
        return json.loads(message["text"]) if found is None else found

    async def __aenter__(self) -> Self:
        await self._to_server.put({"type": "websocket.connect"})

        async def send(message: dict[str, Any]) -> None:
            await self._may_send.wait()
            await self._to_client.put(message)

        self.task = asyncio.create_task(self._app(self._scope, self._to_server.get, send))
        first = await self._to_client.get()
        if first["type"] != "websocket.accept":
            await self.task
            raise RefusedSocketError(first.get("status", 403))
        self.subprotocol = first["subprotocol"]
        return self

    async def __aexit__(self, *_: object) -> None:
        self.resume()
        await self._to_server.put({"type": "websocket.disconnect", "code": 1000})
        await self.task
