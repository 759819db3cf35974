"""Recordings that survive a crash, in one file or in a series."""

from __future__ import annotations

import errno
import os
import random
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, LogError
from mavstack.logs.recorder import Recorder
from mavstack.wire import Encoder, Packet, Parser, Signing, encode
from tests.cli.conftest import setup_signing

if TYPE_CHECKING:
    from pathlib import Path

TIME = 1_700_000_000.5


def packet(number: int = 0) -> Packet:
    return Packet(encode(common.Attitude(time_boot_ms=number), system=1, component=1), common)


def test_a_recording_can_be_read_while_it_is_written(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    with Recorder(path) as writer:
        writer.write([packet(1), packet(2)], TIME)
        table = open_log(path)["ATTITUDE"]
        assert list(table["time_boot_ms"]) == [1, 2]
        assert path.read_bytes()[:8] == int(TIME * 1e6).to_bytes(8, "big")
        writer.sync()
        assert writer.packets == 2
    writer.sync()
    writer.close()


def test_the_times_of_several_links_are_in_order(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    with Recorder(path) as writer:
        for offset in (0.0, -0.25, 0.5, -3600.0):
            writer.write([packet()], TIME + offset)
    times = open_log(path)["ATTITUDE"]["_time"]
    offsets = [(time - times[0]).astype("timedelta64[ms]").astype(int) for time in times]
    assert offsets == [0, 0, 500, -3_600_000]


def test_an_existing_file_is_never_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    path.write_bytes(b"precious")
    with pytest.raises(LogError, match="never overwrites a file"):
        Recorder(path)
    assert path.read_bytes() == b"precious"
    with pytest.raises(LogError, match="No such file or directory"):
        Recorder(tmp_path / "none" / "flight.tlog")


def test_setup_signing_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    with Recorder(path) as recorder:
        recorder.write([Packet(setup_signing(), common), packet()], TIME)
        assert (recorder.packets, recorder.omitted) == (1, 1)
    assert bytes(range(100, 108)) not in path.read_bytes()
    assert list(open_log(path)) == ["ATTITUDE"]


def test_other_secrets_are_blanked_and_signatures_removed(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    wifi = common.WifiConfigAp(ssid="drone", password="hunter2secret")
    signed = Packet(encode(wifi, system=1, component=1, signing=Signing(bytes(32))), common)
    with Recorder(path) as recorder:
        recorder.write([signed, signed], TIME)
    assert b"hunter2" not in path.read_bytes()
    log = open_log(path)
    assert (len(log["WIFI_CONFIG_AP"]), log.statistics.signed) == (2, 0)


def test_a_full_disk_leaves_complete_records(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    writer = Recorder(path)
    writer.write([packet(1)], TIME)
    complete = path.read_bytes()

    class FullDisk:
        """A file with room for five more bytes."""

        def __init__(self, file) -> None:
            self.file = file

        def write(self, data: bytes) -> int:
            return self.file.write(data[:5])

        def __getattr__(self, name: str):
            return getattr(self.file, name)

    writer._file._file = FullDisk(writer._file._file)
    with pytest.raises(LogError, match=f"{len(complete)} bytes are kept"):
        writer.write([packet(2)], TIME)
    assert path.read_bytes() == complete
    writer.close()


def test_a_disk_error_is_raised(tmp_path: Path) -> None:
    writer = Recorder(tmp_path / "flight.tlog")

    class BrokenDisk:
        def write(self, data: bytes) -> int:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        def truncate(self, size: int) -> None: ...
        def seek(self, size: int) -> None: ...

    file, writer._file._file = writer._file._file, BrokenDisk()
    with pytest.raises(LogError, match="No space left on device"):
        writer.write([packet()], TIME)
    file.close()


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
def test_a_killed_program_leaves_complete_records(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    program = f"""
import os
import random
from mavstack.dialects import common
from mavstack.logs.recorder import Recorder
from mavstack.wire import Packet, encode
writer = Recorder({str(path)!r})
packet = Packet(encode(common.Attitude(), system=1, component=1), common)
for _ in range(100):
    writer.write([packet] * 3, 1.7e9)
os.kill(os.getpid(), {int(signal.SIGKILL)})
"""
    ended = subprocess.run([sys.executable, "-c", program], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert len(open_log(path)["ATTITUDE"]) == 300


# series of files


def numbers(path: Path) -> list[int]:
    return list(open_log(path)["ATTITUDE"]["time_boot_ms"])


def test_a_new_file_begins_before_the_size_is_exceeded(tmp_path: Path) -> None:
    size = len(packet(1).raw) + 8
    with Recorder(tmp_path / "flight.tlog", max_size=2 * size + 3) as recorder:
        for first in (1, 4):
            recorder.write([packet(first), packet(first + 1), packet(first + 2)], TIME)
        assert recorder.packets == 6
        assert recorder.bytes == 6 * size
    names = [f"flight-000{number}.tlog" for number in (1, 2, 3)]
    assert [path.name for path in recorder.files] == names
    assert [numbers(path) for path in recorder.files] == [[1, 2], [3, 4], [5, 6]]


def test_a_record_larger_than_the_size_has_a_file_of_its_own(tmp_path: Path) -> None:
    with Recorder(tmp_path / "flight.tlog", max_size=1) as recorder:
        recorder.write([packet(1), packet(2)], TIME)
    assert [numbers(path) for path in recorder.files] == [[1], [2]]


def test_a_new_file_begins_after_the_duration(tmp_path: Path) -> None:
    with Recorder(tmp_path / "flight.tlog", max_duration=10) as recorder:
        for second in (0, 4, 9.9, 10, 15, 20):
            recorder.write([packet(int(second))], TIME + second)
    assert [numbers(path) for path in recorder.files] == [[0, 4, 9], [10, 15], [20]]


def test_a_series_continues_after_its_last_number(tmp_path: Path) -> None:
    (tmp_path / "flight-0041.tlog").write_bytes(b"")
    (tmp_path / "flight-x.tlog").write_bytes(b"")
    with Recorder(tmp_path / "flight.tlog", max_size=10**6) as recorder:
        assert recorder.path.name == "flight-0042.tlog"


def test_only_the_newest_files_are_kept(tmp_path: Path) -> None:
    other = tmp_path / "flight.tlog"
    other.write_bytes(b"not of the series")
    with Recorder(tmp_path / "flight.tlog", max_size=1, keep=2) as recorder:
        recorder.write([packet(number) for number in range(5)], TIME)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "flight-0004.tlog",
        "flight-0005.tlog",
        "flight.tlog",
    ]


def test_files_that_were_begun_before_are_stored_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stored: list[int] = []
    monkeypatch.setattr("mavstack.logs.recorder.recording_file.os.fsync", stored.append)
    with Recorder(tmp_path / "flight.tlog", max_size=1) as recorder:
        recorder.write([packet(1), packet(2), packet(3)], TIME)
        recorder.sync()
        assert len(stored) == 3
        recorder.sync()
        assert len(stored) == 4, "files that were closed are stored once"


@pytest.mark.parametrize(
    "options", [{"max_size": 0}, {"max_duration": -1.0}, {"keep": 0, "max_size": 5}, {"keep": 3}]
)
def test_limits_that_make_no_sense_are_refused(tmp_path: Path, options: dict[str, float]) -> None:
    with pytest.raises(InvalidArgumentError):
        Recorder(tmp_path / "flight.tlog", **options)
    assert not list(tmp_path.iterdir())


def test_the_name_selects_the_format(tmp_path: Path) -> None:
    for name, options in (("flight.PCAP", {}), ("flight.tlog", {"format": "pcap"})):
        with Recorder(tmp_path / name, **options):
            pass
        assert (tmp_path / name).read_bytes()[:4] == bytes.fromhex("d4c3b2a1")
    with Recorder(tmp_path / "flight.data"):
        pass
    assert not (tmp_path / "flight.data").read_bytes()
    with pytest.raises(InvalidArgumentError, match="tlog, pcap"):
        Recorder(tmp_path / "flight.csv", format="csv")


def test_standard_output_is_one_file(capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    with pytest.raises(InvalidArgumentError, match="standard output"):
        Recorder("-", max_size=5)
    with Recorder("-") as recorder:
        recorder.write([packet(1)], TIME)
        recorder.sync()
    assert capfdbinary.readouterr().out[8:] == packet(1).raw


def test_a_series_whose_next_file_fails_keeps_the_present_one(tmp_path: Path, monkeypatch) -> None:
    with Recorder(tmp_path / "a.tlog", max_size=40) as writer:
        writer.write([packet(1)], TIME)

        def refuse(*_: object) -> None:
            raise LogError("no next file")

        with monkeypatch.context() as patch:
            patch.setattr(writer, "_next_file", refuse)
            with pytest.raises(LogError, match="no next file"):
                writer.write([packet(2)] * 3, TIME)
        writer.sync()
        writer.write([packet(3)], TIME)
    assert sum(len(open_log(path)["ATTITUDE"]) for path in writer.files) == 2


def test_an_old_file_that_cannot_be_removed_is_reported(tmp_path: Path) -> None:
    (tmp_path / "a-0001.tlog").mkdir()
    with pytest.raises(LogError, match=r"cannot remove .*a-0001\.tlog"):
        Recorder(tmp_path / "a.tlog", max_size=60, keep=1)


def stream(count: int = 60) -> bytes:
    """Return packets of both versions, with secrets, signatures and damage among them."""
    encoders = [Encoder(1, 1), Encoder(2, 1, version=1), Encoder(3, 1, signing=Signing(bytes(32)))]
    rng, parts = random.Random(count), []
    for number in range(count):
        encoder = rng.choice(encoders)
        message = rng.choice(
            [common.Attitude(time_boot_ms=number), common.AuthKey(key="secret"), common.Statustext(text="x")]
        )
        parts.append(encoder.encode(message))
        if number % 17 == 5:
            parts += [b"\xfdjunk", setup_signing()]
    return b"".join(parts)


@pytest.mark.parametrize("name", ["flight.tlog", "flight.pcap"])
@pytest.mark.parametrize("limits", [{}, {"max_size": 700}, {"max_duration": 2.0}])
def test_bytes_are_recorded_as_their_packets_are(tmp_path: Path, name: str, limits: dict) -> None:
    data, found = stream(), []
    for is_fed in (False, True):
        folder = tmp_path / str(is_fed)
        folder.mkdir()
        parser = Parser(common)
        with Recorder(folder / name, **limits) as writer:
            received = 0
            for number, start in enumerate(range(0, len(data), 333)):
                part, time = data[start : start + 333], TIME + number
                if is_fed:
                    received += writer.feed(parser, part, time)
                else:
                    packets = parser.feed(part)
                    writer.add(packets, time)
                    received += len(packets)
                if number % 3 == 0:
                    writer.flush()
            writer.flush()
            counts = (received, writer.packets, writer.bytes, writer.omitted)
        files = {path.name: path.read_bytes() for path in folder.iterdir()}
        assert not any(b"secret" in each for each in files.values())
        found.append((counts, files))
    assert found[0] == found[1]
    assert found[0][0][3] > 2


def test_refused_packets_are_not_recorded(tmp_path: Path) -> None:
    parser = Parser(common, signing=Signing(bytes(32)))
    with Recorder(tmp_path / "flight.tlog") as writer:
        unsigned, signed = Encoder(1, 1), Encoder(1, 1, signing=Signing(bytes(32)))
        data = b"".join(encoder.encode(common.Attitude(roll=1)) for encoder in (unsigned, signed))
        assert writer.feed(parser, data, TIME) == 1
        writer.flush()
        assert writer.packets == 1
