"""The parameters of a vehicle while it is flashed: saved in a file before, restored after.

The file stays if anything fails, also the power of this machine: the next firmware that is flashed over the
same port restores it.
"""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import RemoteError
from mavstack.files.parameters import (
    Outcome,
    ParameterFile,
    ParameterLoad,
    read_parameters,
    write_parameters,
)
from mavstack.user_directories import state_directory

if TYPE_CHECKING:
    from pathlib import Path

    from mavstack.vehicle import Vehicle

_FOLDER: Final = "flashing"
_FORMAT: Final = "qgroundcontrol"
_SUFFIX: Final = ".params"
_RESTORED: Final = "-restored"


@dataclass(frozen=True, slots=True)
class Restored:
    """The outcome of restoring.

    Attributes:
        path: The file of the parameters.
        set: Parameters that were set.
        unchanged: Parameters that had their values.
        failed: Names of parameters that the vehicle refused or does not have any more.
    """

    path: Path
    set: int
    unchanged: int
    failed: tuple[str, ...]


def dump_path(port: str, folder: Path | None = None) -> Path:
    """Return the file for the settings of a flight controller at a port."""
    return (state_directory() / _FOLDER if folder is None else folder) / f"{_name_of(port)}.txt"


class ParameterBackup:
    """The file with the parameters of the vehicle at one port.

    Args:
        port: The port, as the user names it.
        folder: The folder; None: that of the user's state.
    """

    def __init__(self, port: str, folder: Path | None = None) -> None:
        self._folder = state_directory() / _FOLDER if folder is None else folder
        self.path = self._folder / f"{_name_of(port)}{_SUFFIX}"

    @property
    def is_pending(self) -> bool:
        """True if there are parameters that were not restored yet."""
        return self.path.is_file()

    async def save(self, vehicle: Vehicle) -> int:
        """Download all parameters into the file.

        Args:
            vehicle: The vehicle.

        Returns:
            The number of parameters.

        Raises:
            RemoteError: The parameters cannot be downloaded.
        """
        found = await vehicle.params.download()
        system, component = vehicle.address
        file = ParameterFile.of(
            (found[name] for name in sorted(found)), system=system, component=component, comments=()
        )
        self._folder.mkdir(parents=True, exist_ok=True)
        write_parameters(self.path, file, _FORMAT)
        return len(found)

    async def restore(self, vehicle: Vehicle) -> Restored:
        """Set the parameters of the file that differ, also those that belong to this vehicle, and save them.

        Args:
            vehicle: The vehicle.

        Returns:
            The outcome.

        Raises:
            RemoteError: The parameters cannot be downloaded.
        """
        file = read_parameters(self.path, _FORMAT)
        wanted = file.by_name(vehicle.address.component)
        load = ParameterLoad(vehicle.params, wanted.values(), everything=True)
        results = await load.run()
        with suppress(RemoteError):  # not an error: the values were set, and PX4 saves them without a command
            await vehicle.params.commit()
        done = self.path.with_name(f"{self.path.stem}{_RESTORED}{_SUFFIX}")
        self.path.replace(done)
        outcomes = [each.outcome for each in results]
        failed = tuple(each.name for each in results if not each.ok)
        return Restored(done, outcomes.count(Outcome.SET), outcomes.count(Outcome.UNCHANGED), failed)


def _name_of(port: str) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "-", port).strip("-") or "port"
