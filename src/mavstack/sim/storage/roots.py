"""The file tree that a vehicle serves over MAVLink FTP: its store, and the firmware's virtual files."""

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

#: Capacity in bytes of a store in memory, for logs and uploads together.
MEMORY_CAPACITY = 32 << 20
#: Capacity of a store in a folder: bytes, and number of files and directories.
FOLDER_CAPACITY, MAX_FOLDER_ENTRIES = 256 << 20, 4096

_ARDUPILOT_DIRECTORIES = ("/APM/LOGS", "/APM/scripts", "/APM/TERRAIN")
_PX4_DIRECTORIES = ("/fs/microsd/log", "/fs/microsd/etc")
_PX4_FILES = {
    "/etc/init.d/rcS": "# Start script of a simulated vehicle: it starts nothing.\n",
    "/etc/init.d/rc.logging": "# Logs start at arming and end at disarming (SDLOG_MODE 0).\n",
    "/etc/logging/README": "Logs are in /fs/microsd/log, by day and start time.\n",
}


def file_store(folder: str | os.PathLike[str] | None = None) -> FileStore:
    """Return a store in a folder, created if missing, or in memory."""
    if folder is None:
        return MemoryStore(capacity=MEMORY_CAPACITY)
    Path(folder).mkdir(parents=True, exist_ok=True)
    return DirectoryStore(folder, capacity=FOLDER_CAPACITY, max_entries=MAX_FOLDER_ENTRIES)


def ardupilot_root(
    store: FileStore,
    parameters: ParameterTable,
    plan: Callable[[int], Plan],
    uptime: Callable[[], float],
    *,
    set_parameters: Callable[[Sequence[Parameter]], None] | None = None,
    set_plan: Callable[[Plan], None] | None = None,
) -> OverlayStore:
    """Return ArduPilot's files: `@PARAM`, `@MISSION` and `@SYS`, and the memory card with /APM.

    Args:
        store: The memory card.
        parameters: The table behind `@PARAM/param.pck`.
        plan: Returns the plan of a MAV_MISSION_TYPE.
        uptime: Returns the seconds since boot.
        set_parameters: Sets uploaded parameters, or raises OSError; None makes the file read-only.
        set_plan: Replaces a plan by an uploaded one, or raises OSError; None makes the files read-only.
    """
    for path in _ARDUPILOT_DIRECTORIES:
        make_directories(store, path)
    root = OverlayStore(store, system_files(uptime))
    root.add(PACKED_NAME, packed_file(parameters, set_parameters))
    for kind, path in PLAN_FILES.items():
        root.add(path, _plan_file(kind, plan, set_plan))
    return root


def px4_root(store: FileStore, parameters: ParameterTable) -> OverlayStore:
    """Return PX4's files: /etc, and the memory card at /fs/microsd with the changed parameters."""
    for path in _PX4_DIRECTORIES:
        make_directories(store, path)
    root = OverlayStore(store, {"/fs/microsd/params": bson_file(parameters)})
    for path, text in _PX4_FILES.items():
        root.add(path, _text_file(text))
    return root


def _plan_file(
    kind: int, plan: Callable[[int], Plan], set_plan: Callable[[Plan], None] | None
) -> VirtualFile:
    """Return the virtual file of a plan."""

    def write(content: bytes) -> None:
        found = unpack_plan(content)
        new_plan = None if found is None or found.plan.type != kind else found.applied_to(plan(kind))
        if new_plan is None or set_plan is None:
            raise OSError(EINVAL, "no such plan")
        set_plan(new_plan)

    return VirtualFile(lambda query: pack_plan(plan(kind)), None if set_plan is None else write)


def _text_file(text: str) -> VirtualFile:
    """Return a virtual file with a constant text."""
    return VirtualFile(lambda query: text.encode())
