from __future__ import annotations

import pytest

from mavstack.msp import Direction, Frame, FrameVersion
from mavstack.msp.frame import NO_REPLY
from tests.sim.msp.peer import Peer


@pytest.mark.parametrize("version", list(FrameVersion))
def test_a_reply_has_the_version_of_its_request(version):
    reply = Peer().request(2, version=version)
    assert reply is not None
    assert reply.payload == b"BTFL"
    assert reply.version is (FrameVersion.V1 if version is FrameVersion.JUMBO else version)


def test_an_unknown_command_is_refused():
    reply = Peer().request(0x2FFF)
    assert reply == Frame(0x2FFF, b"", Direction.ERROR, FrameVersion.V2)


def test_replies_and_noise_are_not_answered():
    peer = Peer()
    assert peer.send(Frame(2, b"", Direction.RESPONSE).encode()) == b""
    assert peer.send(b"$Mnoise $X GET / HTTP/1.1\r\n\r\n") == b""
    assert peer.request(2) is not None


@pytest.mark.parametrize(("firmware", "answers"), [("betaflight", True), ("inav", False)])
def test_inav_honours_the_flag_that_wants_no_reply(firmware, answers):
    frame = Frame(2, version=FrameVersion.V2, flags=NO_REPLY).encode()
    assert bool(Peer(firmware).send(frame)) is answers


def test_a_peer_that_reads_nothing_costs_bounded_memory(monkeypatch):
    monkeypatch.setattr("mavstack.sim.msp.port.MAX_PENDING", 4000)
    peer = Peer()
    request = Frame(116).encode()
    for _ in range(30):
        peer.controller.receive(peer.port, request)
    assert 3000 < len(peer.output()) <= 4000


def test_a_hash_opens_the_cli_a_moment_later_unless_a_frame_follows():
    peer = Peer()
    assert peer.send(b"#") == b""
    assert peer.request(2) is not None
    peer.run(0.2)
    assert peer.output() == b""
    assert "Entering CLI Mode" in peer.enter_cli()
    assert peer.port.has_cli
    assert b"$M>" not in peer.send(Frame(2).encode())


def test_peers_have_sessions_of_their_own():
    peer = Peer()
    other = peer.controller.open_port("other")
    peer.enter_cli()
    peer.controller.receive(other, Frame(2).encode())
    assert peer.controller.data_to_send() == [(other, Frame(2, b"BTFL", Direction.RESPONSE).encode())]
