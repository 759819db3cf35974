"""MAVSDK as a test peer: its plugins by name, in another process (see `mavsdk_agent`)."""

from __future__ import annotations

import asyncio
import json
import sys
from contextlib import asynccontextmanager
from importlib.util import find_spec
from itertools import count
from pathlib import Path

import pytest

AGENT = Path(__file__).with_name("mavsdk_agent.py")
#: Seconds for one answer, enough for a busy machine.
TIMEOUT = 40.0

needs_mavsdk = pytest.mark.skipif(find_spec("mavsdk") is None, reason="mavsdk has no wheel for this platform")


class MavsdkError(Exception):
    """A call of MAVSDK ended with this error."""


class Stream:
    """The values that a MAVSDK callback was called with."""

    def __init__(self) -> None:
        self.values: asyncio.Queue = asyncio.Queue()

    async def get(self):
        """Return the next value, or a tuple if the callback takes several."""
        async with asyncio.timeout(TIMEOUT):
            values = await self.values.get()
        return values[0] if len(values) == 1 else tuple(values)

    async def wait_for(self, predicate):
        """Return the first value for which `predicate` is true."""
        received: list = []
        try:
            async with asyncio.timeout(TIMEOUT):
                while not predicate(value := await self.get()):
                    received.append(value)
        except TimeoutError:
            raise AssertionError(f"no matching value; the last ones: {received[-5:]}") from None
        return value


class MavsdkPeer:
    """A client of the agent: `peer.call("param", "get_param_int", "NAME")`."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process
        self._numbers = count(1)
        self._answers: dict[int, asyncio.Future] = {}
        self._streams: dict[int, Stream] = {}
        self._reader = asyncio.create_task(self._read())

    async def connect(self, url: str) -> None:
        assert await self._ask(connect=url) == "SUCCESS"

    async def discover(self) -> None:
        """Wait for the autopilot that the client plugins use."""
        assert await self._ask(discover=TIMEOUT), "no autopilot discovered"

    async def call(self, plugin: str, method: str, *arguments):
        return await self._ask(plugin=plugin, method=method, arguments=arguments)

    async def stream(self, plugin: str, method: str, *arguments) -> Stream:
        """Call a method with a callback: `subscribe_…` or `…_async`."""
        number = next(self._numbers)
        self._streams[number] = stream = Stream()
        await self._ask(number, plugin=plugin, method=method, arguments=arguments, stream=True)
        return stream

    async def _ask(self, number: int | None = None, **request):
        if self._reader.done():
            raise MavsdkError("MAVSDK's process ended")
        number = next(self._numbers) if number is None else number
        self._answers[number] = answer = asyncio.get_running_loop().create_future()
        self._process.stdin.write(json.dumps({"id": number, **request}).encode() + b"\n")
        try:
            async with asyncio.timeout(TIMEOUT):
                reply = await answer
        except TimeoutError:
            raise AssertionError(f"no answer to {request}") from None
        if "error" in reply:
            raise MavsdkError(reply["error"])
        return reply["result"]

    async def _read(self) -> None:
        async for line in self._process.stdout:
            reply = json.loads(line)
            if "stream" in reply:
                self._streams[reply["stream"]].values.put_nowait(reply["values"])
            elif not (answer := self._answers.pop(reply["id"])).done():
                answer.set_result(reply)
        for answer in self._answers.values():
            if not answer.done():
                answer.set_result({"error": "MAVSDK's process ended"})

    async def close(self) -> None:
        self._process.stdin.close()
        try:
            async with asyncio.timeout(5):
                await self._process.wait()
        except TimeoutError:
            self._process.kill()
            await self._process.wait()
        await self._reader


@asynccontextmanager
async def mavsdk_peer(url: str, role: str = "client", system: int = 245, component: int = 190):
    """Run MAVSDK for the length of a block: a `client` that has discovered the autopilot, or a `server`."""
    command = (sys.executable, str(AGENT), role, str(system), str(component))
    pipe, nowhere = asyncio.subprocess.PIPE, asyncio.subprocess.DEVNULL
    process = await asyncio.create_subprocess_exec(
        *command, stdin=pipe, stdout=pipe, stderr=nowhere, limit=1 << 24
    )
    peer = MavsdkPeer(process)
    try:
        await peer.connect(url)
        if role == "client":
            await peer.discover()
        yield peer
    finally:
        await peer.close()


def mavsdk_object(name: str, **fields):
    """Return the JSON form of an object of a MAVSDK plugin, such as `mission_raw.MissionItem`."""
    return {"class": name, **fields}
