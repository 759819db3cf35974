"""The observer of a recording."""

from __future__ import annotations

from mavstack.cli.record.observer import RecordingObserver
from mavstack.cli.watch.observer import Selection
from mavstack.dialects import common
from mavstack.logs.recorder import Recorder
from tests.cli.conftest import flight


def test_selected_packets_are_passed_on_without_being_counted_by_message():
    observer = RecordingObserver(common.dialect, Selection(system=255))
    passed = []
    observer.tap = lambda packets, time: passed.extend(packets)
    observer.open("link")
    observer.receive("link", b"".join(flight(3)), 0.0, time=1.0)
    assert [packet.system for packet in passed] == [255]
    assert observer.totals().packets == 5
    assert not observer.traffic.streams


def test_without_a_selection_the_recorder_parses(tmp_path):
    for selection, returned in ((Selection(), 0), (Selection(system=1), 5)):
        observer = RecordingObserver(common.dialect, selection)
        with Recorder(tmp_path / f"{returned}.tlog") as recorder:
            observer.record_to(recorder)
            observer.open("link")
            assert len(observer.receive("link", b"".join(flight(3)), 0.0, time=1.0)) == returned
            recorder.flush()
            assert (recorder.packets, observer.received) == ((5, 5) if returned == 0 else (4, 4))
        assert observer.totals().packets == 5
