from __future__ import annotations

import pytest

from mavstack.cli.watch.notices import MAX_NOTICES, Notices, is_notice
from mavstack.dialects import Dialect, common
from mavstack.files.parameter_metadata import MetadataCache
from mavstack.services.ftp import file_crc32
from mavstack.wire import Encoder, Parser
from tests.services.events.test_definitions import document

ALL = Dialect.load("all")
STOPPED = common.Event(id=0x01000005, log_levels=0x62, arguments=b"\x01")
UNKNOWN = common.Event(id=0x01000006, log_levels=0x62)


@pytest.fixture(autouse=True)
def cached_metadata(monkeypatch, tmp_path):
    """Keep the metadata of a firmware's events, and a damaged file, in the cache."""
    monkeypatch.setattr("mavstack.files.parameter_metadata.cache.cache_directory", lambda: tmp_path)
    cache = MetadataCache()
    cache.store_crc(common.CompMetadataType.EVENTS, file_crc32(document()), document())
    cache.store_crc(common.CompMetadataType.EVENTS, 5, b"damaged")
    cache.store_crc(common.CompMetadataType.PARAMETER, 5, b"{}")


def packets(*messages, system: int = 1):
    encoder = Encoder(system, 1)
    return Parser(ALL).feed(b"".join(encoder.encode(message) for message in messages))


def text(words: str) -> common.Statustext:
    return common.Statustext(severity=common.MavSeverity.NOTICE, text=words)


def test_status_texts_and_known_events_are_shown():
    found = Notices().texts(packets(text("PreArm: GPS"), STOPPED, UNKNOWN))
    assert found == ["1/1 NOTICE: PreArm: GPS", "1/1 CRITICAL: Stopped: too hot at 0.0 m"]


def test_a_text_that_has_an_event_is_shown_only_without_it():
    marked = text("Stopped\t")
    assert Notices().texts(packets(text("a"), marked, STOPPED)) == [
        "1/1 NOTICE: a",
        "1/1 CRITICAL: Stopped: too hot at 0.0 m",
    ]
    assert Notices().texts(packets(marked, UNKNOWN)) == ["1/1 NOTICE: Stopped"]
    other = packets(STOPPED, system=2)
    assert Notices().texts([*packets(marked), *other])[0] == "1/1 NOTICE: Stopped"


def test_the_last_notices_are_shown():
    found = Notices().texts(packets(*(text(str(number)) for number in range(9))))
    assert found == [f"1/1 NOTICE: {number}" for number in range(9 - MAX_NOTICES, 9)]


def test_events_for_programs_are_no_notices():
    program = common.Event(id=0x01000005, log_levels=0x68)
    assert [is_notice(packet) for packet in packets(STOPPED, program, text("a"), common.Heartbeat())] == [
        True,
        False,
        True,
        False,
    ]
