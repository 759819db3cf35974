"""MAVSDK as a client, by its own Python package: the blocking calls of its examples."""

from __future__ import annotations

import importlib
import threading
from time import perf_counter
from typing import TYPE_CHECKING, Any

from .child import Answer, Job, serve

if TYPE_CHECKING:
    from collections.abc import Callable

CONNECT_TIMEOUT = 15.0


class _Session:
    """A connection with the autopilot found on it; its plugins live as long as the session."""

    def __init__(self, job: Job) -> None:
        mavsdk: Any = importlib.import_module("mavsdk")
        configuration = mavsdk.Configuration.create_with_component_type(mavsdk.ComponentType.GROUND_STATION)
        self._mavsdk = mavsdk.Mavsdk(configuration)
        self._mavsdk.add_any_connection(f"udpout://127.0.0.1:{job['port']}")
        self._system = self._mavsdk.first_autopilot(CONNECT_TIMEOUT)
        if self._system is None:
            raise TimeoutError("no autopilot was found")

    def plugin(self, module: str, name: str) -> Any:  # noqa: ANN401 (the package has no types)
        """Return a plugin of MAVSDK for the autopilot."""
        return getattr(importlib.import_module(f"mavsdk.plugins.{module}"), name)(self._system)


def _parameters(job: Job) -> Answer:
    session = _Session(job)
    plugin = session.plugin("param", "Param")
    start = perf_counter()
    params = plugin.get_all_params()
    seconds = perf_counter() - start
    all_params = (*params.int_params, *params.float_params)
    return {"seconds": seconds, "parameters": {item.name: float(item.value) for item in all_params}}


def _file(job: Job, *, burst: bool) -> Answer:
    session = _Session(job)
    plugin = session.plugin("ftp", "Ftp")
    ended = threading.Event()
    results: list[Any] = []

    def progress(result: Any, data: Any, _: Any = None) -> None:  # noqa: ANN401
        if result.name != "NEXT":
            results.append(result)
            ended.set()

    start = perf_counter()
    plugin.download_async(job["remote_file"], job["folder"], burst, progress)
    if not ended.wait(job["timeout"]):
        return {"problem": "timed out"}
    seconds = perf_counter() - start
    name = results[0].name
    return {"seconds": seconds} if name == "SUCCESS" else {"problem": name, "seconds": seconds}


def _mission_up(job: Job) -> Answer:
    session = _Session(job)
    plugin = session.plugin("mission_raw", "MissionRaw")
    item: Any = importlib.import_module("mavsdk.plugins.mission_raw").MissionItem
    items = [
        item(seq=seq, frame=f, command=c, current=int(seq == 0), autocontinue=1, x=x, y=y, z=z)
        for seq, (f, c, x, y, z) in enumerate(job["plan"])
    ]
    start = perf_counter()
    plugin.upload_mission(items)
    return {"seconds": perf_counter() - start}


def _mission_down(job: Job) -> Answer:
    session = _Session(job)
    plugin = session.plugin("mission_raw", "MissionRaw")
    start = perf_counter()
    items = plugin.download_mission()
    seconds = perf_counter() - start
    return {"seconds": seconds, "plan": [(i.frame, i.command, i.x, i.y, i.z) for i in items]}


WORKS: dict[str, Callable[[Job], Answer]] = {
    "parameters": _parameters,
    "file": lambda job: _file(job, burst=False),
    "file-burst": lambda job: _file(job, burst=True),
    "mission-up": _mission_up,
    "mission-down": _mission_down,
}

if __name__ == "__main__":
    serve(WORKS)
