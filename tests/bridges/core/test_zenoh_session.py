from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest

from mavstack.bridges.core.zenoh_session import (
    RouterReports,
    SessionOptions,
    close_session,
    open_session,
    zenoh_module,
)
from mavstack.errors import LinkError, MissingExtraError
from tests.bridges.ros2.running import free_port


def test_a_certificate_makes_the_session_mutual_tls() -> None:
    values = SessionOptions(("tls/a:1",), ca="ca.pem", certificate="a.pem", private_key="a.key").values()
    assert values["transport/link/tls/enable_mtls"] is True
    assert values["connect/endpoints"] == ["tls/a:1"]
    assert not any("tls" in key for key in SessionOptions().values())


def test_a_full_queue_never_delays_a_put() -> None:
    values = SessionOptions().values()
    assert values["transport/link/tx/queue/congestion_control/drop/wait_before_drop"] == 0


def test_without_the_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "zenoh", None)
    with pytest.raises(MissingExtraError, match=r"mavstack\[zenoh\]"):
        zenoh_module("a fleet over Zenoh")


class Info:
    """The information of a session: its listener of connections."""

    def __init__(self) -> None:
        self.listeners: list[Any] = []

    def declare_transport_events_listener(self, callback: Any, history: bool) -> Any:
        self.listeners.append(callback)
        return SimpleNamespace(undeclare=lambda: self.listeners.remove(callback))


def test_a_lost_router_is_reported_until_the_session_closes(caplog: pytest.LogCaptureFixture) -> None:
    handlers = SimpleNamespace(Callback=lambda callback, indirect: callback)
    zenoh = SimpleNamespace(SampleKind=SimpleNamespace(PUT=0, DELETE=1), handlers=handlers)
    info = Info()
    reports = RouterReports(zenoh, SimpleNamespace(info=info), ("tcp/a:7447",))
    (listener,) = info.listeners
    for kind in (0, 1, 0, 0):  # connected, lost, back, and a second connection
        listener(SimpleNamespace(kind=kind))
    lost, back = caplog.messages
    assert lost == "the Zenoh router tcp/a:7447 is lost; samples are lost until it is back"
    assert back.startswith("the Zenoh router tcp/a:7447 is back after 0.")
    reports.end()
    reports.end()
    assert info.listeners == []


def test_an_older_zenoh_reports_no_routers() -> None:
    zenoh = SimpleNamespace(SampleKind=SimpleNamespace(PUT=0))
    RouterReports(zenoh, SimpleNamespace(info=SimpleNamespace()), ("tcp/a:7447",)).end()


@pytest.mark.interop
def test_a_peer_needs_no_router() -> None:
    async def scenario() -> None:
        zenoh = zenoh_module("a test")
        await close_session(await open_session(zenoh, SessionOptions((), "peer")))
        with pytest.raises(LinkError, match=r"connecting to the Zenoh router .* failed"):
            await open_session(zenoh, SessionOptions((f"tcp/127.0.0.1:{free_port()}",), timeout=0.3))

    asyncio.run(scenario())
