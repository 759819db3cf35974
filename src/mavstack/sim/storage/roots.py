"""What others see of a vehicle's files by MAVLink FTP: its store, and over it what the firmware makes."""

from __future__ import annotations

from errno import EINVAL
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.services.ftp import DirectoryStore, MemoryStore, OverlayStore, VirtualFile
from mavstack.services.mission import PLAN_FILES, pack_plan, unpack_plan
from mavstack.services.parameters.packed import PACKED_NAME
from mavstack.sim.storage.flight_logs import make_directories
from mavstack.sim.storage.parameter_files import bson_file, packed_file
from mavstack.sim.storage.system_files import system_files

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Sequence

    from mavstack.services.ftp import FileStore
    from mavstack.services.mission import Plan
    from mavstack.services.parameters import Parameter, ParameterTable

#: A vehicle whose files are in memory keeps so many bytes, logs and what others upload together.
MEMORY_CAPACITY = 32 << 20

_ARDUPILOT_DIRECTORIES = ("/APM/LOGS", "/APM/scripts", "/APM/TERRAIN")
_PX4_DIRECTORIES = ("/fs/microsd/log", "/fs/microsd/etc")
_PX4_FILES = {
    "/etc/init.d/rcS": "# Start script of a simulated vehicle: nothing is started from here.\n",
    "/etc/init.d/rc.logging": "# Logs begin at arming and end at disarming (SDLOG_MODE 0).\n",
    "/etc/logging/README": "Logs are in /fs/microsd/log, by the day and the second they began.\n",
}


def file_store(folder: str | os.PathLike[str] | None = None) -> FileStore:
    """Where a vehicle's files lie: in a folder, which is made if need be, or in memory."""
    if folder is None:
        return MemoryStore(capacity=MEMORY_CAPACITY)
    Path(folder).mkdir(parents=True, exist_ok=True)
    return DirectoryStore(folder)


def ardupilot_root(
    store: FileStore,
    parameters: ParameterTable,
    plan: Callable[[int], Plan],
    uptime: Callable[[], float],
    *,
    set_parameters: Callable[[Sequence[Parameter]], None] | None = None,
    put_plan: Callable[[Plan], None] | None = None,
) -> OverlayStore:
    """ArduPilot's files: `@PARAM`, `@MISSION` and `@SYS` over the memory card, which has /APM.

    `plan` gives the plan of a type; `put_plan` and `set_parameters` take what somebody wrote to their files,
    and raise OSError if they refuse it. Without them those files can only be read.
    """
    for path in _ARDUPILOT_DIRECTORIES:
        make_directories(store, path)
    root = OverlayStore(store, system_files(uptime))
    root.add(PACKED_NAME, packed_file(parameters, set_parameters))
    for kind, path in PLAN_FILES.items():
        root.add(path, _plan_file(kind, plan, put_plan))
    return root


def px4_root(store: FileStore, parameters: ParameterTable) -> OverlayStore:
    """PX4's files: /etc, and the memory card at /fs/microsd with the parameters that were set."""
    for path in _PX4_DIRECTORIES:
        make_directories(store, path)
    root = OverlayStore(store, {"/fs/microsd/params": bson_file(parameters)})
    for path, text in _PX4_FILES.items():
        root.add(path, _text_file(text))
    return root


def _plan_file(
    kind: int, plan: Callable[[int], Plan], put_plan: Callable[[Plan], None] | None
) -> VirtualFile:
    def write(content: bytes) -> None:
        found = unpack_plan(content)
        wanted = None if found is None or found.plan.type != kind else found.applied_to(plan(kind))
        if wanted is None or put_plan is None:
            raise OSError(EINVAL, "no such plan")
        put_plan(wanted)

    return VirtualFile(lambda query: pack_plan(plan(kind)), None if put_plan is None else write)


def _text_file(text: str) -> VirtualFile:
    return VirtualFile(lambda query: text.encode())
