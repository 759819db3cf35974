"""Attacks on the parser: incomplete signatures, bytes full of false magics, packets from the future."""

from __future__ import annotations

from time import process_time, time

import pytest

from mavstack import Encoder, Parser, Signing
from mavstack.dialects import common

KEY = bytes(range(32))
YEAR = 365 * 24 * 3600.0
HEARTBEAT = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)


def signed_packets(count, *, now, link_id=1):
    encoder = Encoder(1, 1, signing=Signing(KEY, link_id))
    return [encoder.encode(HEARTBEAT, now) for _ in range(count)]


@pytest.mark.parametrize("missing", range(1, 14))
@pytest.mark.parametrize("signed", [True, False])
@pytest.mark.parametrize("cut", [True, False])
def test_a_signature_that_lacks_bytes_hides_no_packet(missing, signed, cut):
    now = 1_767_225_600.0  # no magic byte in the signatures, behind which a parser would wait
    first, second, third = signed_packets(3, now=now)
    parser = Parser(common, signing=Signing(KEY) if signed else None)
    chunks = [first[:-missing], second, third]
    received = [
        packet.raw for chunk in (chunks if cut else [b"".join(chunks)]) for packet in parser.feed(chunk, now)
    ]
    assert received[-2:] == [second, third]
    assert len(received) == (2 if signed else 3)


@pytest.mark.parametrize(
    "pattern",
    [b"\xfe", b"\xfd", b"\xfe\xff\x01", b"\xfe\xfd\xfe\xfe\xfe\xfe\xc9", b"\xfd\xff\x01\xfd\xff\x00\xfd"],
)
def test_the_work_for_bytes_full_of_false_magics_is_bounded(pattern):
    def seconds(data):
        parser, durations = Parser(common), []
        for _ in range(20):
            start = process_time()
            for _ in range(40):
                parser.feed(data)
            durations.append((process_time() - start) / 40)
        return min(durations)

    junk = (pattern * 1400)[:1400]
    ordinary = b"".join(Encoder(1, 1).encode(HEARTBEAT) for _ in range(66))
    # A datagram full of valid packets takes about 10 us.
    # Without the bound it is more than 18 times; a busy machine disturbs the ratio.
    assert seconds(junk) < 14 * seconds(ordinary)


def test_a_packet_from_the_future_is_refused_without_a_current_time():
    (packet,) = signed_packets(1, now=time() + 10 * YEAR)
    parser = Parser(common, signing=Signing(KEY))
    assert parser.feed(packet) == []
    assert parser.signing.refusals.future == 1
    (packet,) = signed_packets(1, now=time())
    assert len(parser.feed(packet)) == 1


def test_the_statistics_of_forged_sources_are_bounded():
    parser = Parser(common)
    genuine = Encoder(1, 1)
    for _ in range(20):
        parser.feed(genuine.encode(HEARTBEAT))
    for system in range(256):
        forged = [
            Encoder(system, component).encode(HEARTBEAT)
            for component in range(1, 256)
            if system != 1 and system
        ]
        parser.feed(b"".join(forged))
    assert len(parser.sources) <= 1024
    assert parser.sources[1, 1].received == 20
