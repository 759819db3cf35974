from __future__ import annotations

import asyncio

import pytest

from mavstack.bridges.core.zenoh_session import SessionOptions, close_session, open_session, zenoh_module
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


@pytest.mark.interop
def test_a_peer_needs_no_router() -> None:
    async def scenario() -> None:
        zenoh = zenoh_module("a test")
        await close_session(await open_session(zenoh, SessionOptions((), "peer")))
        with pytest.raises(LinkError, match=r"connecting to the Zenoh router .* failed"):
            await open_session(zenoh, SessionOptions((f"tcp/127.0.0.1:{free_port()}",), timeout=0.3))

    asyncio.run(scenario())
