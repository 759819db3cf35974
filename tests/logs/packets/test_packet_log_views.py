from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import LogError
from mavstack.logs import PacketLog, open_log
from tests.logs.files import encoded, stamped

ATTITUDES = [common.Attitude(number, number / 8) for number in range(10)]


@pytest.fixture
def write(tmp_path):
    def write(data, name="log.tlog"):
        path = tmp_path / name
        path.write_bytes(data)
        return path

    return write


def test_a_raw_stream_is_selected_by_time_where_messages_have_one(write):
    log = open_log(write(b"".join(encoded([common.Heartbeat(), *ATTITUDES])), "flight.mavlink"))
    assert len(log.select("ATTITUDE", end=0.004)["ATTITUDE"]) == 4
    reason = (
        r"cannot select rows of HEARTBEAT by time: .* has no times of reception, and HEARTBEAT has no time"
    )
    with pytest.raises(LogError, match=reason):
        dict(log.select(end=0.004))


def test_the_rows_of_a_system_are_counted_by_the_sources(write, monkeypatch):
    packets = [common.Heartbeat()] * 3
    log = open_log(write(stamped(encoded(packets))))
    monkeypatch.setattr(PacketLog, "decode_tables", lambda *_: pytest.fail("a table was decoded"))
    (system, component), *_ = log.sources
    assert log.select(system=system, component=component).counts == {"HEARTBEAT": 3}
    assert log.select(system=system + 1).counts == {}
