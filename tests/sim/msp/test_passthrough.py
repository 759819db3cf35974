from __future__ import annotations

from functools import reduce
from operator import xor

from tests.sim.msp.peer import Peer


def test_the_gps_receiver_sends_sentences_until_its_peer_leaves():
    peer = Peer()
    peer.run(1.0)
    assert peer.request(245, bytes([0xFD, 1])).payload == b"\1"
    peer.run(1.0)
    sentences = peer.output().decode().splitlines()
    assert [sentence[:6] for sentence in sentences[:2]] == ["$GPGGA", "$GPRMC"]
    assert len(sentences) in (10, 12)
    text, checksum = sentences[0][1:].split("*")
    assert reduce(xor, text.encode(), 0) == int(checksum, 16)
    assert text.split(",")[2][:6] == "4723.8"
    assert peer.request(2) is None
    peer.controller.close_port(peer.port)
    peer.connect()
    assert peer.request(2) is not None


def test_escs_and_other_ports_are_not_there():
    peer = Peer()
    for payload in (b"", bytes([0xFF, 0]), bytes([0xFD, 5]), bytes([0xFD]), bytes([0, 0])):
        assert peer.request(245, payload).payload == b"\0"
    assert peer.request(2) is not None
