"""The generator of a station: foreign definitions are bounded in time, memory and number."""

from __future__ import annotations

import asyncio
import os
import sys
from typing import TYPE_CHECKING

import pytest

from mavstack.codegen import make_library
from mavstack.codegen.limits import MAX_MESSAGES
from mavstack.dialects.lookup import find_dialect
from mavstack.errors import InvalidArgumentError
from mavstack.http.bodies import RefusedError
from mavstack.server.generator import runner
from mavstack.server.generator.runner import MAX_FORMS, GeneratorRunner
from mavstack.server.generator.work import Work

if TYPE_CHECKING:
    from pathlib import Path


def definition(messages: int) -> bytes:
    each = '<message id="{0}" name="M{0}"><field type="uint8_t" name="a"/></message>'
    listed = "".join(each.format(number) for number in range(1, messages + 1))
    return f"<mavlink><messages>{listed}</messages></mavlink>".encode()


def work(*, archive: bool = True, file: str = "custom.xml") -> Work:
    options = {"only": "", "exclude": "", "package": ""}
    return Work("common", file, ["c"], "mavlink", options, archive=archive)


def test_a_dialect_with_too_many_messages_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "custom.xml"
    path.write_bytes(definition(MAX_MESSAGES + 1))
    with pytest.raises(InvalidArgumentError, match=r"has 4,097 messages, more than 4,096: select"):
        make_library(find_dialect(str(path)))
    assert len(make_library(find_dialect(str(path)), only=["M1*"]).messages) < MAX_MESSAGES


async def test_a_large_definition_is_refused_with_its_reason() -> None:
    """Before: three definitions of 2.8 MB held the generator for 45 s, with 495 MB."""
    data = definition(36_000)
    assert len(data) > 2_400_000
    with pytest.raises(RefusedError, match="has 36,000 messages"):
        await GeneratorRunner().run(work(), data)


async def test_few_forms_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    running = []

    def answer(_: Work, folder: Path) -> dict[str, object]:
        running.append(folder)
        return {"problems": {}, "commands": []}

    monkeypatch.setattr(runner, "_answer_of", answer)
    generator = GeneratorRunner()
    forms = [generator.run(work(archive=False, file="")) for _ in range(MAX_FORMS + 3)]
    answers = await asyncio.gather(*forms, return_exceptions=True)
    assert [type(each) for each in answers].count(RefusedError) == 3
    assert len(running) == MAX_FORMS
    assert not any(folder.exists() for folder in running)
    await generator.run(work(archive=False, file=""))


@pytest.mark.parametrize("command", ["while True: pass", "bytes(2 << 30)", "raise SystemExit(1)"])
async def test_a_process_that_exceeds_its_limits_is_refused(
    monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    limited = "from mavstack.server.generator import work; work.MAX_SECONDS = 1; work._limit()"
    monkeypatch.setattr(runner, "_COMMAND", ("-c", f"{limited}\n{command}"))
    with pytest.raises(RefusedError, match="exceeds the limits on its time and memory"):
        await GeneratorRunner().run(work(file=""))


async def test_a_process_that_waits_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "_COMMAND", ("-c", "import time; time.sleep(600)"))
    monkeypatch.setattr(runner, "TIMEOUT", 0.2)
    with pytest.raises(RefusedError, match="exceeds the limits"):
        await GeneratorRunner().run(work(file=""))


@pytest.mark.skipif(sys.platform == "win32", reason="the system has other priorities")
async def test_the_process_yields_to_the_station(monkeypatch: pytest.MonkeyPatch) -> None:
    show = "import json, os; print(json.dumps({'problems': {}, 'commands': [str(os.nice(0))]}))"
    limited = "from mavstack.server.generator import work; work._limit()"
    monkeypatch.setattr(runner, "_COMMAND", ("-c", f"{limited}\n{show}"))
    (niceness,) = (await GeneratorRunner().run(work(file="", archive=False))).commands
    assert int(niceness) == min(19, os.nice(0) + 10)
