"""A caster of NTRIP for tests: it checks the password, sends corrections each moment, and keeps requests."""

from __future__ import annotations

import threading
from contextlib import contextmanager
from socketserver import BaseRequestHandler, ThreadingTCPServer
from typing import TYPE_CHECKING, Any

from tests.gnss.test_ntrip import TABLE
from tests.gnss.test_rtcm import msm, station

if TYPE_CHECKING:
    from collections.abc import Iterator

#: "me:secret" as Basic authentication sends it.
TOKEN = b"Basic bWU6c2VjcmV0"


class Caster(ThreadingTCPServer):
    """A caster with the mountpoint NEAR, for the user `me` with the password `secret`."""

    daemon_threads = True
    allow_reuse_address = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.requests: list[bytes] = []
        self.sentences: list[bytes] = []
        #: Epochs after which a connection is closed.
        self.epochs = 10_000
        self.stopped = threading.Event()

    @property
    def url(self) -> str:
        return f"ntrip://me:secret@127.0.0.1:{self.server_address[1]}/NEAR"


class _Handler(BaseRequestHandler):
    server: Any

    def handle(self) -> None:
        request = b""
        while b"\r\n\r\n" not in request:
            data = self.request.recv(4096)
            if not data:
                return
            request += data
        self.server.requests.append(request)
        if request.startswith(b"GET / "):
            self.request.sendall(b"SOURCETABLE 200 OK\r\n\r\n" + TABLE + b"ENDSOURCETABLE\r\n")
        elif TOKEN not in request:
            self.request.sendall(b"HTTP/1.1 401 Unauthorized\r\n\r\n")
        else:
            self.request.sendall(b"ICY 200 OK\r\n\r\n")
            self._stream()

    def _stream(self) -> None:
        self.request.settimeout(0.05)
        for epoch in range(self.server.epochs):
            frames = [station(), msm(1074, epoch, 400), msm(1084, epoch, 177)]
            try:
                self.request.sendall(b"".join(frame.data for frame in frames))
                self.server.sentences.append(self.request.recv(4096))
            except TimeoutError:
                pass
            except OSError:
                return
            if self.server.stopped.is_set():
                return


@contextmanager
def caster() -> Iterator[Caster]:
    """Run a caster on a port that the system chooses."""
    server = Caster()
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
    thread.start()
    try:
        yield server
    finally:
        server.stopped.set()
        server.shutdown()
        server.server_close()
        thread.join()
