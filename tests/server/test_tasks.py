from __future__ import annotations

import asyncio
from types import SimpleNamespace

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.http.bodies import RefusedError
from mavstack.security.roles import Role
from mavstack.server import tasks as tasks_module
from mavstack.server.tasks import Tasks, TaskState


async def states(task):
    return [(values["state"], values["done"]) async for values in task.follow()]


async def test_progress_and_result_are_kept(monkeypatch) -> None:
    monkeypatch.setattr(tasks_module, "REPORT_INTERVAL", 0)
    go = asyncio.Event()

    async def work(task):
        task.report(1, 2)
        await go.wait()
        return "answer"

    task = Tasks().start("GET /x", work)
    following = asyncio.create_task(states(task))
    await asyncio.sleep(0.01)
    go.set()
    found = await following
    assert found[-1] == ("done", 1)
    assert ("running", 1) in found
    assert task.result == "answer"


async def test_an_error_is_kept_and_a_defect_is_not_described(caplog) -> None:
    async def fail(task):
        raise InvalidArgumentError("not so")

    async def break_down(task):
        raise ZeroDivisionError("secret")

    tasks = Tasks()
    known, defect = tasks.start("a", fail), tasks.start("b", break_down)
    await states(known)
    await states(defect)
    assert known.values()["error"] == {"kind": "InvalidArgumentError", "text": "not so"}
    assert defect.values()["error"]["kind"] == "InternalError"
    assert "secret" not in str(defect.values())
    assert "ZeroDivisionError" in caplog.text


async def test_the_size_of_results_is_bounded(monkeypatch) -> None:
    monkeypatch.setattr(tasks_module, "MAX_RESULTS", 100)

    async def download(task):
        return SimpleNamespace(body=bytes(60))

    tasks = Tasks()
    for _ in range(4):
        await states(tasks.start("download", download))
    assert [each.id for each in tasks.list()] == ["3", "4"]


async def test_the_number_of_tasks_is_bounded(monkeypatch) -> None:
    monkeypatch.setattr(tasks_module, "MAX_RUNNING", 2)
    monkeypatch.setattr(tasks_module, "MAX_ENDED", 2)

    async def wait(task):
        await asyncio.Event().wait()

    async def end(task):
        return None

    tasks = Tasks()
    for _ in range(4):
        await states(tasks.start("short", end))
    assert [each.id for each in tasks.list()] == ["3", "4"]
    running = [tasks.start("long", wait), tasks.start("long", wait)]
    with pytest.raises(RefusedError, match="2 tasks run already"):
        tasks.start("long", wait)
    assert (await tasks.remove(running[0].id)).state is TaskState.CANCELLED
    await tasks.close()
    assert running[1].state is TaskState.CANCELLED


async def test_clients_that_observe_leave_tasks_to_pilots(monkeypatch) -> None:
    monkeypatch.setattr(tasks_module, "MAX_OBSERVED", 1)

    async def wait(task):
        await asyncio.Event().wait()

    tasks = Tasks()
    tasks.start("long", wait, role=Role.OBSERVE)
    with pytest.raises(RefusedError, match="1 tasks run already"):
        tasks.start("long", wait, role=Role.OBSERVE)
    tasks.start("long", wait, role=Role.OPERATE)
    await tasks.close()
