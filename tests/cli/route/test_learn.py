"""`mav route learn`, and `mav route check` of what it wrote."""

from __future__ import annotations

import struct

from mavstack.dialects import common
from mavstack.wire import Encoder


def recording(path) -> str:
    encoder = Encoder(1, 1)
    times = (struct.pack(">Q", 1_790_000_000_000_000 + step) for step in range(5))
    data = b"".join(time + encoder.encode(common.Heartbeat()) for time in times)
    path.write_bytes(data)
    return str(path)


def test_rules_are_learned_from_a_recording_and_valid(mav, tmp_path):
    out = tmp_path / "rules.toml"
    result = mav("route", "learn", recording(tmp_path / "flight.tlog"), "-o", str(out))
    assert (result.code, result.err) == (0, "")
    assert 'messages = ["HEARTBEAT"]' in out.read_text()
    assert mav("route", "learn", recording(tmp_path / "flight.tlog")).out == out.read_text()
    checked = mav("route", "check", str(out))
    assert (checked.code, checked.err) == (0, "")
    out.write_text(out.read_text().replace("messages = ", "mesages = "))
    assert "did you mean messages?" in mav("route", "check", str(out)).err


def test_files_without_packets_are_refused(mav, tmp_path):
    empty = tmp_path / "empty.tlog"
    empty.write_bytes(b"nothing")
    assert "has no MAVLink packets" in mav("route", "learn", str(empty)).err
    assert "cannot open" in mav("route", "learn", str(tmp_path / "missing")).err
    assert mav("route", "learn").code == 2
