from __future__ import annotations

import io
import json
import socket
import sys
import threading
import time
from contextlib import contextmanager

import pytest

from mavstack.cli.watch.link_follower import Follower
from mavstack.cli.watch.observer import Observer
from mavstack.cli.watch.sources import recording_path
from mavstack.dialects import Dialect, common
from mavstack.errors import LogError
from mavstack.links import open_link
from mavstack.security import SigningKey
from mavstack.wire import Encoder
from tests.cli.conftest import START, flight, stamped

# files


def test_summary_as_json(mav, tlog):
    result = mav("watch", tlog, "--once", "--json")
    assert (result.code, result.err) == (0, "")
    summary = json.loads(result.out)
    assert summary["packets"] == 22
    assert summary["messages"] == {"ATTITUDE": 20, "HEARTBEAT": 2}
    assert summary["unknown"] == {}
    assert summary["bad_bytes"] == summary["signed"] == summary["lost"] == 0
    assert summary["sources"] == ["1/1", "255/190"]
    assert summary["duration_s"] == 2.1


def test_summary_as_text(mav, tlog):
    result = mav("watch", tlog, "--once")
    assert (result.code, result.err) == (0, "")
    assert "22 packets in 2.1 s" in result.out
    assert "quadrotor" in result.out
    assert "ArduPilot" in result.out
    assert "ARMED LOITER active" in result.out
    assert "roll 28.6°" in result.out
    assert max(map(len, result.out.splitlines())) <= 160


def test_one_json_line_per_packet(mav, tlog):
    lines = [json.loads(line) for line in mav("watch", tlog, "--json").out.splitlines()]
    assert len(lines) == 22
    assert lines[0]["time"] == START / 1e6
    assert lines[2]["message"] == "ATTITUDE"
    assert lines[2]["fields"]["roll"] == 0.5
    assert lines[2]["fields"]["pitch"] == "NaN"
    assert (lines[1]["system"], lines[1]["component"], lines[1]["id"]) == (255, 190, 0)


def test_one_text_line_per_packet_in_a_pipe(mav, tlog):
    lines = mav("watch", tlog).out.splitlines()
    assert len(lines) == 22
    assert "1/1 ATTITUDE time_boot_ms=0 ms roll=28.6°" in lines[2]


@pytest.mark.parametrize("time", [2**64 - 1, 2**63, 253_402_300_800_000_000, 253_402_300_799_999_999])
def test_times_beyond_the_calendar(mav, tmp_path, time):
    path = tmp_path / "far.tlog"
    path.write_bytes(b"".join(time.to_bytes(8, "big") + packet for packet in flight(0)))
    result = mav("watch", path)
    assert (result.code, result.err) == (0, "")
    assert result.out.startswith("--:--:--.---")
    assert mav("watch", path, "--once").code == 0


def test_raw_packets_have_no_times(mav, tmp_path):
    path = tmp_path / "packets.raw"
    path.write_bytes(b"junk" + b"".join(flight()))
    summary = json.loads(mav("watch", path, "--once", "--json").out)
    assert summary["duration_s"] is None
    assert (summary["packets"], summary["bad_bytes"]) == (22, 4)
    assert json.loads(mav("watch", path, "--json").out.splitlines()[0])["time"] is None
    assert mav("watch", path, "--for", 1).code == 1


def test_last_packet_after_an_incomplete_one(mav, tmp_path):
    path = tmp_path / "shorten.raw"
    path.write_bytes(b"\xfd\xff\x00\x00" + b"".join(flight(0)))
    assert json.loads(mav("watch", path, "--once", "--json").out)["packets"] == 2


def test_unknown_ids_are_counted_by_id(mav, tlog):
    summary = json.loads(mav("watch", tlog, "--once", "--json", "--dialect", "minimal").out)
    assert summary["messages"] == {"HEARTBEAT": 2}
    assert summary["unknown"] == {"30": 20}


@pytest.mark.parametrize(
    ("options", "count"),
    [
        (["--filter", "heartbeat"], 2),
        (["--filter", "ATT*,0"], 22),
        (["--filter", "30"], 20),
        (["--system", "255"], 1),
        (["--for", "1"], 11),
    ],
)
def test_part_of_a_file(mav, tlog, options, count):
    assert json.loads(mav("watch", tlog, "--once", "--json", *options).out)["packets"] == count
    assert len(mav("watch", tlog, "--json", *options).out.splitlines()) == count


def test_unknown_message_is_wrong_usage(mav, tlog):
    result = mav("watch", tlog, "--filter", "ATITUDE")
    assert result.code == 2
    assert "did you mean ATTITUDE?" in result.err


def test_custom_dialect(mav, tlog, tmp_path):
    path = tmp_path / "mine.xml"
    path.write_text(
        '<mavlink><messages><message id="0" name="BEAT"><field type="uint32_t" name="custom_mode"/>'
        "</message></messages></mavlink>"
    )
    result = mav("watch", tlog, "--once", "--json", "--dialect", path)
    assert result.code == 0
    assert json.loads(result.out)["unknown"] == {"30": 20}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "no MAVLink packet"),
        (b"nothing of interest" * 100, "no MAVLink packet"),
        (b"ULog\x01\x12\x35\x00", "a PX4 ULog"),
        (b"\xa3\x95\x80\x80", "an ArduPilot dataflash log"),
    ],
)
def test_file_without_packets_is_a_failure(mav, tmp_path, content, message):
    path = tmp_path / "other"
    path.write_bytes(content)
    result = mav("watch", path, "--once")
    assert result.code == 1
    assert message in result.err
    assert result.err.count("\n") == 1


def test_json_summary_of_a_file_without_packets(mav, tmp_path):
    path = tmp_path / "other"
    path.write_bytes(b"nothing of interest")
    result = mav("watch", path, "--once", "--json")
    assert result.code == 0
    assert json.loads(result.out)["packets"] == 0


@pytest.mark.parametrize("name", ["missing.tlog", "folder"])
def test_unreadable_file_is_a_failure(mav, tmp_path, name):
    (tmp_path / "folder").mkdir()
    result = mav("watch", tmp_path / name)
    assert result.code == 1
    assert name in result.err


def test_standard_input(mav, monkeypatch):
    class Stdin:
        buffer = io.BytesIO(stamped(flight()))

    monkeypatch.setattr(sys, "stdin", Stdin)
    assert json.loads(mav("watch", "-", "--once", "--json").out)["packets"] == 22


def test_sources_that_are_files_or_links(tmp_path, tlog, monkeypatch):
    assert recording_path(str(tlog)) == str(tlog)
    assert recording_path(f"file://{tlog}") == str(tlog)
    assert recording_path(f"file://{tlog}?speed=2") is None
    assert recording_path("udpin://0.0.0.0:14550") is None
    assert recording_path("-") == "-"
    odd = tmp_path / "folder"
    odd.mkdir()
    assert recording_path("nonsense") is None
    monkeypatch.chdir(tmp_path)
    with pytest.raises(LogError):
        recording_path("folder")


def test_replay_at_a_speed(mav, tlog):
    result = mav("watch", tlog, "--speed", "max", "--json")
    lines = [json.loads(line) for line in result.out.splitlines()]
    assert len(lines) == 22
    assert lines[0]["time"] == pytest.approx(START / 1e6)
    assert mav("watch", tlog, "--speed", "fast").code == 2


# links


@contextmanager
def sender(data: bytes):
    """Someone who sends to a free port until it is left."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    done = threading.Event()

    def send():
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            while not done.wait(0.01):
                out.sendto(data, ("127.0.0.1", port))

    thread = threading.Thread(target=send)
    thread.start()
    try:
        yield f"udpin://127.0.0.1:{port}"
    finally:
        done.set()
        thread.join()


def test_summary_of_a_link(mav):
    with sender(flight(0)[0]) as url:
        result = mav("watch", url, "--once", "--json", "--for", "0.3")
    assert result.code == 0
    summary = json.loads(result.out)
    assert list(summary["messages"]) == ["HEARTBEAT"]
    assert summary["sources"] == ["1/1"]
    assert summary["duration_s"] >= 0.3


def test_lines_of_a_link(mav):
    with sender(flight(0)[0]) as url:
        result = mav("watch", url, "--json", "--for", "0.3")
    assert result.code == 0
    assert json.loads(result.out.splitlines()[0])["message"] == "HEARTBEAT"


def test_silence_is_a_failure(mav):
    result = mav("watch", "udpin://127.0.0.1:0", "--once", "--for", "0.05")
    assert result.code == 1
    assert "no data received" in result.err


def test_bytes_without_packets_are_a_failure(mav):
    with sender(b"hello") as url:
        result = mav("watch", url, "--once", "--for", "0.3")
    assert result.code == 1
    assert "no MAVLink packet" in result.err


def test_invalid_url_is_wrong_usage(mav):
    assert mav("watch", "udpinn://127.0.0.1:14550").code == 2


async def test_link_is_followed_to_its_end(tlog):
    follower = Follower(Observer(Dialect.load("all")))
    async with open_link(f"file://{tlog}?speed=max") as link:
        await follower.follow(link)
    assert follower.observer.totals().packets == 22
    assert follower.observer.channels == {}
    assert follower.note.endswith("end of file")


# keys


@contextmanager
def signed_sender(key: SigningKey):
    """Send signed packets and unsigned ones; yield the URL on which they arrive."""
    signed = Encoder(1, 1, signing=key.signing()).encode(common.Attitude(), time.time())
    with sender(signed + flight(0)[0]) as url:
        yield url


def test_with_a_key_only_packets_signed_with_it_are_shown(mav, tmp_path):
    key, other = SigningKey.generate(), SigningKey.generate()
    key.save(tmp_path / "fleet.key")
    other.save(tmp_path / "other.key")
    with signed_sender(key) as url:
        result = mav("watch", url, "--once", "--json", "--for", "0.4", "--key", tmp_path / "fleet.key")
    summary = json.loads(result.out)
    assert summary["messages"] == {"ATTITUDE": 1}
    assert summary["refused"] > 0
    with signed_sender(key) as url:
        result = mav("watch", url, "--once", "--for", "0.4", "--key", tmp_path / "other.key")
    assert result.code == 1
    assert "are unsigned or signed with another key" in result.err


def test_an_unknown_key_is_reported(mav):
    result = mav("watch", "udpin://127.0.0.1:0", "--once", "--key", "nokey")
    assert result.code == 1
    assert "there is no signing key 'nokey'" in result.err
