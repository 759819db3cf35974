from __future__ import annotations

import json
from io import BufferedReader, BytesIO, RawIOBase
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.registry import command_parser
from mavstack.errors import InvalidArgumentError
from mavstack.server.rows.framing import MAX_DATAGRAM
from tests.server.rows.test_source import DECODER, FRAME

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def decoder(tmp_path: Path) -> str:
    path = tmp_path / "bench.json"
    path.write_text(json.dumps({"type": "mavstack-decoder", **DECODER}), "utf-8")
    return str(path)


def run(*words: str) -> int:
    arguments = command_parser("data").parse_args(["decode", *words])
    return int(arguments.run_action(arguments))


def test_a_decoder_is_checked_alone(decoder: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(decoder) == 0
    assert capsys.readouterr().out == "bench is valid; messages: BENCH\n"


def test_frames_of_files_digits_and_the_standard_input(
    decoder: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "capture.bin").write_bytes(b"noise" + FRAME)
    assert run(decoder, str(tmp_path / "capture.bin")) == 0
    assert run(decoder, "--hex", FRAME.hex(), "--json") == 0
    monkeypatch.setattr("sys.stdin", SimpleNamespace(buffer=BytesIO(FRAME)))
    assert run(decoder, "-") == 0
    row = {"message": "BENCH", "fields": {"volts": 130.0}}
    text, first, second = capsys.readouterr().out.splitlines()
    assert (text, json.loads(first), second) == ("BENCH volts=130.0", row, text)


def test_rows_of_a_pipe_are_printed_before_it_ends(
    decoder: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    printed: list[str] = []

    class Pipe(RawIOBase):
        def readable(self) -> bool:
            return True

        def readinto(self, buffer: Any) -> int:
            printed.append(capsys.readouterr().out)
            data = FRAME if len(printed) == 1 else b""
            buffer[: len(data)] = data
            return len(data)

    monkeypatch.setattr("sys.stdin", SimpleNamespace(buffer=BufferedReader(Pipe())))
    assert run(decoder, "-") == 0
    assert printed == ["", "BENCH volts=130.0\n"]


def test_a_file_is_one_datagram(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, capture = tmp_path / "raw.json", tmp_path / "capture.bin"
    path.write_text('{"type": "mavstack-decoder"}', "utf-8")
    capture.write_bytes(bytes(MAX_DATAGRAM))
    assert run(str(path), str(capture)) == 0
    assert capsys.readouterr().out.startswith(f"FRAME size={MAX_DATAGRAM}.0 ")
    capture.write_bytes(bytes(2 * MAX_DATAGRAM))
    with pytest.raises(CommandError, match="0 rows; 1 frames"):
        run(str(path), str(capture))


def test_damaged_frames_are_a_failure_after_the_good_ones(
    decoder: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(CommandError, match="1 rows; 1 frames were damaged"):
        run(decoder, "--hex", (FRAME + FRAME[:3] + b"\0").hex())
    assert capsys.readouterr().out == "BENCH volts=130.0\n"


def test_wrong_words(decoder: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="hexadecimal digits"):
        run(decoder, "--hex", "xyz")
    with pytest.raises(UsageError, match="not both"):
        run(decoder, "file", "--hex", "aa")
    with pytest.raises(CommandError, match="No such file"):
        run(decoder, str(tmp_path / "missing.bin"))
    with pytest.raises(InvalidArgumentError, match="no decoder other"):
        run(decoder, "--name", "other")
