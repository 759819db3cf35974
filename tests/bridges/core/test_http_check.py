"""Requests to servers that do not speak HTTP."""

from __future__ import annotations

import asyncio
import socket
import threading

import pytest

from mavstack.bridges.core.http_check import ask
from mavstack.errors import LinkError


@pytest.mark.parametrize("answer", [b"SSH-2.0-OpenSSH_9.2\r\n", b""], ids=["ssh", "nothing"])
def test_an_answer_that_is_not_http(answer: bytes) -> None:
    def serve() -> None:
        client, _ = server.accept()
        with client:
            client.recv(4096)
            client.sendall(answer)

    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=serve)
        thread.start()
        url = f"http://127.0.0.1:{server.getsockname()[1]}/metrics"
        with pytest.raises(LinkError, match=rf"asking {url} failed: no HTTP server answers there"):
            asyncio.run(ask(url))
        thread.join()


def test_a_host_that_is_no_name() -> None:
    with pytest.raises(LinkError, match="failed"):
        asyncio.run(ask("http://a b:80/metrics"))
