"""The web hook of RockBLOCK as a link, with a simulated gateway for messages to the modem."""

from __future__ import annotations

import asyncio
from urllib.parse import parse_qs

import pytest

from mavstack.errors import LinkURLError
from mavstack.handshakes import MAX_HANDSHAKES
from mavstack.links import BytesReceived, open_link

IMEI = "300234010753370"


async def post(port: int, body: bytes, path: str = "/hook") -> int:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(f"POST {path} HTTP/1.1\r\nHost: x\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body)
    status = int((await reader.readline()).split()[1])
    writer.close()
    return status


async def test_messages_go_both_ways(tmp_path):
    requests: asyncio.Queue[bytes] = asyncio.Queue()

    async def gateway(reader, writer):
        head = await reader.readuntil(b"\r\n\r\n")
        size = int(head.lower().partition(b"content-length:")[2].split()[0])
        requests.put_nowait(await reader.readexactly(size))
        writer.write(b"HTTP/1.1 200 OK\r\nContent-Length: 4\r\nConnection: close\r\n\r\nOK,1")
        await writer.drain()
        writer.close()

    account = tmp_path / "account.txt"
    account.write_text("me\nsecret\n")
    server = await asyncio.start_server(gateway, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    url = f"rockblock://127.0.0.1:0/hook?imei={IMEI}&account={account}&gateway=http://127.0.0.1:{port}/MT"
    async with server, open_link(url) as link:
        (channel,) = link.channels
        hook = f"imei={IMEI}&momsn=7&data=48656c6c6f".encode()
        own = link.address[1]
        assert await post(own, hook) == 200
        assert await post(own, hook) == 200, "repeated by the gateway"
        assert await post(own, hook.replace(b"momsn=7", b"momsn=8")) == 200
        assert await post(own, hook, "/other") == 404
        assert await post(own, b"imei=1&data=00") == 403
        assert await post(own, b"nonsense") == 400
        received = []
        async for event in link:
            if isinstance(event, BytesReceived):
                received.append(event.data)
                if len(received) == 2:
                    break
        assert received == [b"Hello", b"Hello"]
        assert channel.write(b"\x01\x02")
        assert not channel.write(bytes(271))
        async with asyncio.timeout(10):
            form = parse_qs((await requests.get()).decode())
        assert form == {"imei": [IMEI], "username": ["me"], "password": ["secret"], "data": ["0102"]}


@pytest.mark.parametrize("content", [None, "", "only a name\n", "me\n\n"])
def test_an_account_that_cannot_be_used_is_refused(tmp_path, content):
    path = tmp_path / "account.txt"
    if content is not None:
        path.write_text(content)
    with pytest.raises(LinkURLError, match="must be a file of two lines: name and password"):
        open_link(f"rockblock://127.0.0.1:0/hook?account={path}")


async def test_silent_connections_leave_room_for_the_gateway():
    async with open_link(f"rockblock://127.0.0.1:0/hook?imei={IMEI}") as link:
        port = link.address[1]
        silent = [await asyncio.open_connection("127.0.0.1", port) for _ in range(MAX_HANDSHAKES + 5)]
        assert await post(port, f"imei={IMEI}&momsn=7&data=48".encode()) == 200
        assert await silent[0][0].read() == b"", "the oldest made room"
        for _, writer in silent:
            writer.close()
