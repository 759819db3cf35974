"""The kept packets of a message as CSV."""

from __future__ import annotations

import csv
import io

import pytest

from mavstack.cli.watch.inspector.csv_export import csv_text
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from tests.cli.watch.inspector.watched import Watched, stream


def table(watched: Watched, tmp_path, name: str = "out.csv") -> list[dict[str, str]]:
    path = tmp_path / name
    watched.inspector.export(str(path))
    return list(csv.DictReader(io.StringIO(path.read_text())))


def number(text: str) -> str:
    """Return a number in one form: `0` and `0.0` are equal."""
    try:
        return str(float(text))
    except ValueError:
        return text


def test_a_line_for_each_packet(tmp_path):
    watched = Watched()
    watched.fly(3)
    watched.inspector.select(stream())
    rows = table(watched, tmp_path)
    assert rows[0]["_time"] == "2023-11-14 22:13:20.100000Z"
    assert [row["roll"] for row in rows] == ["0.0", "0.1", "0.2"]
    assert {row["pitch"] for row in rows} == {"nan"}
    assert rows[0]["_system"] == rows[0]["_component"] == rows[0]["_sequence"] == "1"


def test_the_columns_are_those_of_the_conversion_of_a_log(mav, tmp_path):
    pytest.importorskip("pyarrow")
    watched = Watched()
    watched.send(common.Attitude(roll=0.1, pitch=float("nan")), common.BatteryStatus(voltages=[4100] * 10))
    watched.send(common.Statustext(text="hello"))
    watched.inspector.update(0.0)
    log = tmp_path / "flight.tlog"
    stamp = int(1e6).to_bytes(8, "big")
    for message_id, name in ((30, "ATTITUDE"), (147, "BATTERY_STATUS"), (253, "STATUSTEXT")):
        watched.inspector.select(stream(message_id))
        (exported,) = table(watched, tmp_path, f"{name}.csv")
        entries = watched.inspector.packets
        log.write_bytes(b"".join(stamp + entry.packet.raw for entry in entries))
        assert mav("data", "convert", log, "--to", "csv", "-o", tmp_path / name).code == 0
        (converted,) = csv.DictReader(io.StringIO((tmp_path / name / f"{name}.csv").read_text()))
        del exported["_time"], converted["_time"]
        assert list(exported) == list(converted)
        assert [number(text) for text in exported.values()] == [number(text) for text in converted.values()]


def test_secrets_are_left_out(tmp_path):
    watched = Watched()
    watched.send(common.SetupSigning(secret_key=bytes(range(100, 132)), initial_timestamp=987654321))
    watched.inspector.update(0.0)
    (row,) = table(watched, tmp_path)
    assert "secret_key" not in row
    assert "987654321" not in row.values()


def test_a_file_is_never_overwritten(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    watched = Watched(links=2)
    watched.fly(1, label="A")
    watched.inspector.select(stream(label="A"))
    path = watched.inspector.default_export_path()
    assert path == "ATTITUDE-A-1-1.csv"
    watched.inspector.export(path)
    assert watched.inspector.default_export_path() == "ATTITUDE-A-1-1-2.csv"
    with pytest.raises(InvalidArgumentError, match=r"ATTITUDE-A-1-1\.csv exists"):
        watched.inspector.export(path)


def test_without_packets_there_is_nothing_to_export():
    with pytest.raises(InvalidArgumentError, match="no packet"):
        csv_text([])
    watched = Watched()
    watched.inspector.update(0.0)
    with pytest.raises(InvalidArgumentError, match="select a message"):
        watched.inspector.default_export_path()
