"""WebSockets at the end of their server, and writes at once."""

from __future__ import annotations

from unittest.mock import Mock

import pytest
import uvicorn
from uvicorn.server import ServerState
from websockets.client import ClientProtocol
from websockets.frames import Close, Opcode
from websockets.protocol import State
from websockets.uri import parse_uri

from mavstack.http.immediate_writes import EXTENSION, WRITE
from mavstack.http.web_socket import WebSocket
from tests.waiting import wait_until


async def echo(scope, receive, send):
    await receive()
    await send({"type": "websocket.accept"})
    while (await receive())["type"] != "websocket.disconnect":
        pass


async def open_socket():
    """Return an open WebSocket of a server, and its client."""
    config = uvicorn.Config(echo, log_config=None, lifespan="off", ws=WebSocket)
    config.load()
    socket, transport = WebSocket(config, ServerState(), {}), Mock()
    transport.is_closing.side_effect = lambda: transport.close.called
    transport.get_extra_info.return_value = None
    transport.get_write_buffer_size.return_value = 0
    client = ClientProtocol(parse_uri("ws://127.0.0.1/"))
    transport.write.side_effect = client.receive_data
    client.send_request(client.connect())
    socket.connection_made(transport)
    socket.data_received(b"".join(client.data_to_send()))
    await wait_until(lambda: socket.handshake_complete)
    return socket, client


@pytest.mark.parametrize("closed", [False, True])
async def test_the_end_of_a_server_closes_each_connection_once(closed):
    socket, client = await open_socket()
    if closed:
        client.send_close(1001)
        socket.data_received(b"".join(client.data_to_send()))
    socket.shutdown()
    assert socket.transport.close.called
    assert client.close_rcvd == (Close(1001, "") if closed else Close(1012, ""))


async def test_messages_of_all_sizes_are_written_at_once():
    socket, client = await open_socket()
    client.events_received()
    sent = ["", "ä" * 62, "x" * 126, b"y" * 65_535, b"z" * 65_536]
    writes = socket.transport.write.call_count
    assert socket.scope["extensions"][EXTENSION][WRITE](sent)
    assert socket.transport.write.call_count == writes + 1
    frames = client.events_received()
    assert [each.data.decode() if each.opcode is Opcode.TEXT else each.data for each in frames] == sent
    assert all(each.fin for each in frames)


async def test_nothing_is_written_past_what_waits_or_after_the_end():
    socket, client = await open_socket()
    client.events_received()
    socket.transport.get_write_buffer_size.return_value = 1
    assert not socket.write_now(["late"])
    socket.transport.get_write_buffer_size.return_value = 0
    socket.shutdown()
    assert not socket.write_now(["late"])
    assert [each.opcode for each in client.events_received()] == [Opcode.CLOSE]
    socket.transport.close()
    socket.conn.state = State.OPEN
    assert not socket.write_now(["late"])
