"""`mav ftp put`: a file on the vehicle is complete or absent, whatever interrupts the upload."""

from __future__ import annotations

import asyncio
import random

import pytest

from mavstack.cli.ftp.upload import Upload
from mavstack.node.ftp import Ftp
from mavstack.services.ftp import FtpError, Opcode
from mavstack.services.ftp.replies import RefusedError
from tests.cli.harness import CliHarness

PATH, PART = "/APM/scripts/x.lua", "/APM/scripts/x.lua.part"
DATA = random.Random(1).randbytes(9000)


@pytest.fixture
def harness(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.lua").write_bytes(DATA)
    return CliHarness(monkeypatch)


def put(mav):
    return mav("ftp", "put", "x.lua", PATH)


def test_a_file_is_replaced(mav, harness):
    harness.put(PATH, b"old")
    assert put(mav).code == 0
    assert harness.file(PATH) == DATA
    assert harness.file(PART) is None


def test_a_cancelled_upload_leaves_neither_a_part_nor_another_file(mav, harness, monkeypatch):
    harness.put(PATH, b"old")
    write = Upload._write

    async def interrupted(self, path, data, progress):
        await write(self, path, data, progress)
        raise asyncio.CancelledError

    monkeypatch.setattr(Upload, "_write", interrupted)
    with pytest.raises(asyncio.CancelledError):
        put(mav)
    assert harness.file(PATH) == b"old"
    assert harness.file(PART) is None


def test_between_the_old_file_and_the_new_one_the_complete_part_stays(mav, harness, monkeypatch, capsys):
    harness.put(PATH, b"old")
    rename, calls = Ftp.rename, []

    async def interrupted(self, *words, **options):
        calls.append(words)
        if len(calls) > 1:
            raise asyncio.CancelledError
        await rename(self, *words, **options)

    monkeypatch.setattr(Ftp, "rename", interrupted)
    with pytest.raises(asyncio.CancelledError):
        put(mav)
    assert (harness.file(PATH), harness.file(PART)) == (None, DATA)
    assert f"interrupted: the complete file is {PART}" in capsys.readouterr().err


def test_a_rename_whose_answer_was_lost(mav, harness, monkeypatch):
    """The repeated request is refused, since the part is gone: that is no reason to remove the new file."""
    rename = Ftp.rename

    async def repeated(self, *words, **options):
        await rename(self, *words, **options)
        await rename(self, *words, **options)

    monkeypatch.setattr(Ftp, "rename", repeated)
    assert put(mav).code == 0
    assert harness.file(PATH) == DATA


def test_a_server_that_cannot_rename_gets_the_file_in_place(mav, harness):
    harness.put(PATH, b"old")

    def unknown(*_: object) -> None:
        raise RefusedError(FtpError.UNKNOWNCOMMAND)

    harness.vehicle.services.files._handlers[Opcode.RENAME] = unknown
    assert put(mav).code == 0
    assert harness.file(PATH) == DATA
    assert harness.file(PART) is None
