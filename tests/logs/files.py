"""Recordings made by the tests, and their tables made again the slow way."""

from __future__ import annotations

import numpy as np

import mavstack
from tests.wire.values import comparable, text_of

START = 1_700_000_000_000_000


def stamped(packets, start=START, step=1000):
    """A tlog of packets that came `step` microseconds apart."""
    return b"".join((start + step * number).to_bytes(8, "big") + raw for number, raw in enumerate(packets))


def encoded(messages, *, system=1, component=1, version=2):
    """One source's packets."""
    encoder = mavstack.Encoder(system, component, version=version)
    return [encoder.encode(message) for message in messages]


def parsed(data, dialect, *, timestamped):
    """All packets by name, as the parser finds them."""
    parser = mavstack.Parser(dialect, timestamped=timestamped)
    found = {}
    for packet in parser.feed(data) + parser.flush():
        found.setdefault(packet.name, []).append(packet)
    return found, parser


def assert_same(table, packets):
    """The table holds what the packets hold, field by field, bit by bit."""
    assert len(table) == len(packets)
    header = [(packet.system, packet.component, packet.sequence, packet.version) for packet in packets]
    columns = ("_system", "_component", "_sequence", "_version")
    assert [tuple(row) for row in table[list(columns)].tolist()] == header
    times = [packet.timestamp for packet in packets]
    assert [None if np.isnat(time) else int(time.astype("i8")) for time in table["_time"]] == times
    for field in packets[0].message.definition.fields:
        values = [getattr(packet.message, field.name) for packet in packets]
        column = table[field.name].tolist()
        if field.type == "char":
            assert [text_of(value) for value in column] == values, field
        else:
            assert [comparable(value, field.type) for value in column] == [
                comparable(value, field.type) for value in values
            ], field
