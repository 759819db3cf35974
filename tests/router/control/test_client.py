from __future__ import annotations

import socket
import threading

import pytest

from mavstack.errors import LinkError
from mavstack.router.control.client import ControlClient


def test_without_a_router_the_error_has_a_remedy():
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{unused.getsockname()[1]}"
    with pytest.raises(LinkError, match=r"cannot reach the router at .*: Connection refused: is it running"):
        ControlClient(address).endpoints()


@pytest.mark.parametrize("answer", [b"HTTP/1.0 200 OK\r\n\r\nhello", b"SSH-2.0\r\n", b""])
def test_other_servers_are_errors(answer):
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve():
            client, _ = server.accept()
            with client:
                client.recv(4096)
                client.sendall(answer)

        thread = threading.Thread(target=serve)
        thread.start()
        with pytest.raises(LinkError, match=r"is not a router of Mavstack|cannot reach the router"):
            ControlClient(f"127.0.0.1:{server.getsockname()[1]}").endpoints()
        thread.join()
