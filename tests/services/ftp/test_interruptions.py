"""Downloads from a vehicle that pauses, and may have lost its session when it is back."""

from __future__ import annotations

from random import Random

import pytest

from mavstack.errors import FileDenied, FileTimeout, RemoteProtocolError
from mavstack.services.ftp import FtpServer, MemoryStore
from tests.services.ftp.harness import FtpHarness
from tests.services.network import VEHICLE

DATA = Random(7).randbytes(200_000)


class PausingServer(FtpServer):
    """A server that receives nothing for a while; then it handles the last packets that waited.

    ArduPilot keeps five requests, and closes the file of a session whose reply could not be sent for 3 s.
    """

    seconds, waiting_packets, loses_sessions = 8.0, 5, False

    def __init__(self, *args, **options) -> None:
        super().__init__(*args, **options)
        self.paused_at = None
        self.waiting = []
        self.openings = 0

    def receive(self, packet, now) -> None:
        if self.paused_at is None and any(session.burst for session in self.sessions):
            self.paused_at = now
            for session in self.sessions:
                session.burst = None
        if self.paused_at is not None and now < self.paused_at + self.seconds:
            self.waiting = [*self.waiting, packet][: self.waiting_packets]
            return
        if self.waiting:
            packets, self.waiting = self.waiting, []
            if self.loses_sessions:
                for session in self.sessions:
                    self.sessions.drop(session)
            for waiting in packets:
                super().receive(waiting, now)
        super().receive(packet, now)

    def _open(self, request, source, now):
        self.openings += 1
        return super()._open(request, source, now)

    def next_timeout(self):
        due = super().next_timeout()
        return due if self.paused_at is None or due is None else max(due, self.paused_at + self.seconds)

    def bulk_messages(self, now, has_room):
        if self.paused_at is None or now >= self.paused_at + self.seconds:
            yield from super().bulk_messages(now, has_room)


class PausingHarness(FtpHarness):
    def __init__(self, **options) -> None:
        self.options = options
        super().__init__(1, MemoryStore({"f": DATA, "@v": DATA}), bandwidth=50_000)

    def serve(self, engine) -> None:
        server = PausingServer(VEHICLE, self.store)
        vars(server).update(self.options)
        self.servers.append(engine.add(server))

    def download(self, path="f", **options):
        """Download, with a second request that begins the pause in the middle of the burst."""
        operation = self.client.download(path, self.now, **options)
        self.ground.engine.touch(self.client)
        self.network.run(lambda: operation.transfer and operation.transfer.counts.packets > 40, timeout=60)
        self.client.checksum("f", self.now)
        return self.run(operation)


@pytest.mark.parametrize("loses_sessions", [False, True])
@pytest.mark.parametrize("seconds", [2.0, 8.0, 15.0])
def test_a_download_continues_after_a_pause(seconds: float, loses_sessions: bool) -> None:
    harness = PausingHarness(seconds=seconds, loses_sessions=loses_sessions)
    operation = harness.download()
    assert operation.result() == DATA
    assert operation.verified
    if loses_sessions:
        assert harness.server.openings == 2
        assert operation.transfer.counts.packets < len(DATA) / 239 - 30, "it began at the offset reached"


def test_a_generated_file_begins_again() -> None:
    harness = PausingHarness(loses_sessions=True)
    operation = harness.download("@v")
    assert operation.result() == DATA
    assert operation.transfer.counts.packets >= len(DATA) / 239


def test_a_file_of_another_size_after_the_pause_is_an_error() -> None:
    harness = PausingHarness(loses_sessions=True)
    harness.server.sessions.drop = lambda session: (
        harness.server.sessions._open.clear(),
        harness.store.__setitem__("f", DATA[:-1]),
    )
    with pytest.raises(RemoteProtocolError, match="changed during an interruption"):
        harness.download().result()


def test_a_file_that_is_gone_after_the_pause_is_refused() -> None:
    harness = PausingHarness(loses_sessions=True)
    harness.server.sessions.drop = lambda session: (
        harness.server.sessions._open.clear(),
        "f" in harness.store and harness.store.remove("f"),
    )
    with pytest.raises(FileDenied, match="not found"):
        harness.download().result()


def test_a_vehicle_that_stays_silent_ends_in_a_timeout() -> None:
    harness = PausingHarness(seconds=1e9)
    began = harness.now
    with pytest.raises(FileTimeout):
        harness.download().result()
    assert harness.now - began < 45
