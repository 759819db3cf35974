"""Logs of all formats as MCAP with the profile `ros2`, read by two other implementations."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mavstack.bridges.core.types import type_hash
from mavstack.cli.main import main
from tests.logs.test_replay import dataflash

RECORDINGS = Path(__file__).parents[2] / "recordings"


def converted(log: Path, target: Path, *options: str) -> int:
    words = ["data", "convert", str(log), "--to", "mcap", "--profile", "ros2", "-o", str(target), *options]
    return main(words)


def read_by_mcap(path: Path) -> dict[str, list[Any]]:
    """The decoded messages by topic, with mcap-ros2-support."""
    reader = pytest.importorskip("mcap.reader")
    decoder = pytest.importorskip("mcap_ros2.decoder")
    found: dict[str, list[Any]] = {}
    with path.open("rb") as stream:
        opened = reader.make_reader(stream, decoder_factories=[decoder.DecoderFactory()])
        assert opened.get_header().profile == "ros2"
        for _, channel, _, message in opened.iter_decoded_messages():
            found.setdefault(channel.topic, []).append(message)
    return found


def read_by_rosbags(path: Path) -> dict[str, list[Any]]:
    """The decoded messages by topic, with rosbags."""
    highlevel = pytest.importorskip("rosbags.highlevel")
    found: dict[str, list[Any]] = {}
    with highlevel.AnyReader([path]) as reader:
        for connection, _, raw in reader.messages():
            found.setdefault(connection.topic, []).append(reader.deserialize(raw, connection.msgtype))
            assert connection.ext.offered_qos_profiles
    return found


def test_a_tlog_by_two_readers(tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    assert converted(RECORDINGS / "flight.tlog", path) == 0
    first, second = read_by_mcap(path), read_by_rosbags(path)
    counts = {topic: len(messages) for topic, messages in first.items()}
    assert counts == {topic: len(messages) for topic, messages in second.items()}
    assert {"/mavros/state", "/mavros/global_position/global", "/mavros/imu/data"} <= set(counts)
    topic = "/mavros/global_position/global"
    for one, other in zip(first[topic], second[topic], strict=True):
        assert (one.latitude, one.longitude) == (other.latitude, other.longitude)
        assert one.altitude == other.altitude
    assert first["/mavros/statustext/recv"][0].text


def test_a_log_that_the_vehicle_wrote(tmp_path: Path) -> None:
    log = tmp_path / "flight.BIN"
    log.write_bytes(dataflash())
    assert converted(log, tmp_path / "flight.mcap") == 0
    found = read_by_rosbags(tmp_path / "flight.mcap")
    states = found["/mavros/state"]
    assert [states[0].armed, states[-1].armed] == [False, True]
    fixes = found["/mavros/global_position/global"]
    assert fixes[-1].longitude > fixes[0].longitude
    assert "ArduCopter V4.5.7 (2a3dc4b7)" in [text.text for text in found["/mavros/statustext/recv"]]


def test_types_have_their_hashes(tmp_path: Path) -> None:
    reader = pytest.importorskip("mcap.reader")
    path = tmp_path / "flight.mcap"
    assert converted(RECORDINGS / "flight.tlog", path) == 0
    with path.open("rb") as stream:
        summary = reader.make_reader(stream).get_summary()
    for channel in summary.channels.values():
        schema = summary.schemas[channel.schema_id]
        assert channel.metadata["topic_type_hash"] == type_hash(schema.name)
        assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")


def test_a_profile_needs_mcap(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = str(RECORDINGS / "flight.tlog")
    assert main(["data", "convert", log, "--to", "csv", "--profile", "ros2", "-o", str(tmp_path / "x")]) == 2
    assert "--profile is for --to mcap" in capsys.readouterr().err


def test_the_number_of_samples_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert converted(RECORDINGS / "flight.tlog", tmp_path / "x.mcap", "--json") == 0
    written = json.loads(capsys.readouterr().out)
    assert sum(written["rows"].values()) == sum(map(len, read_by_mcap(tmp_path / "x.mcap").values()))
