"""Mavstack as a client: the calls of a program, on a node over UDP."""

from __future__ import annotations

import asyncio
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, TypeAlias

from mavstack.errors import MavstackError
from mavstack.node import Node, RemoteComponent
from mavstack.services.mission import MissionItem

from .child import Answer, Job, serve

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

CONNECT_TIMEOUT = 15.0
GLOBAL_SCALE = 1e7

Task: TypeAlias = "Callable[[RemoteComponent, Job], Awaitable[Answer]]"


async def _parameters(vehicle: RemoteComponent, _job: Job) -> Answer:
    parameters = await vehicle.params.download()
    return {"parameters": {name: float(parameter.value) for name, parameter in parameters.items()}}


async def _listed(vehicle: RemoteComponent, _job: Job) -> Answer:
    parameters = await vehicle.params.download(packed=False)
    return {"parameters": {name: float(parameter.value) for name, parameter in parameters.items()}}


async def _file(vehicle: RemoteComponent, job: Job) -> Answer:
    data = await vehicle.ftp.download(job["remote_file"])
    (Path(job["folder"]) / Path(job["remote_file"]).name).write_bytes(data)
    return {}


async def _mission_up(vehicle: RemoteComponent, job: Job) -> Answer:
    items = [
        MissionItem(command, param5=x / GLOBAL_SCALE, param6=y / GLOBAL_SCALE, param7=z, frame=frame)
        for frame, command, x, y, z in job["plan"]
    ]
    await vehicle.mission.upload(items)
    return {}


async def _mission_down(vehicle: RemoteComponent, _job: Job) -> Answer:
    plan = await vehicle.mission.download()
    return {
        "plan": [
            (
                int(item.frame),
                int(item.command),
                round(item.param5 * GLOBAL_SCALE),
                round(item.param6 * GLOBAL_SCALE),
                item.param7,
            )
            for item in plan.items
        ]
    }


async def _measure(work: Task, job: Job) -> Answer:
    async with Node(f"udpout://127.0.0.1:{job['port']}") as node:
        vehicle = await node.wait_for_autopilot(timeout=CONNECT_TIMEOUT)
        start = perf_counter()
        try:
            async with asyncio.timeout(job["timeout"]):
                answer = await work(vehicle, job)
        except MavstackError as problem:
            return {"problem": f"{type(problem).__name__}: {problem}", "seconds": perf_counter() - start}
        return {**answer, "seconds": perf_counter() - start}


def _program(work: Task) -> Callable[[Job], Answer]:
    return lambda job: asyncio.run(_measure(work, job))


if __name__ == "__main__":
    serve(
        {
            "parameters": _program(_parameters),
            "listed": _program(_listed),
            "file": _program(_file),
            "mission-up": _program(_mission_up),
            "mission-down": _program(_mission_down),
        }
    )
