"""WebSockets at the end of their server."""

from __future__ import annotations

from unittest.mock import Mock

import pytest
import uvicorn
from uvicorn.server import ServerState
from websockets.client import ClientProtocol
from websockets.frames import Close
from websockets.uri import parse_uri

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
