"""The configuration file of a running router: read again on demand, and when it changes.

A file that is not valid changes nothing. A file that is being written is read only when it has been the same
for one interval, because the first half of a configuration can be valid too.
"""

from __future__ import annotations

import asyncio
import logging
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.errors import MavstackError, RouterConfigError
from mavstack.router.config import load_config

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeAlias

    from mavstack.router.config import RouterConfig
    from mavstack.router.router import Router

    #: Modification time, size and inode; None: there is no file.
    Signature: TypeAlias = tuple[int, int, int] | None

_log = logging.getLogger("mavstack.router")
#: Seconds between two checks of the file for changes.
WATCH_INTERVAL = 1.0


class ConfigFile:
    """The configuration file of a router.

    Args:
        path: Path of the file.
        router: The router that runs with it.
        load: Reads the file.
    """

    def __init__(self, path: str, router: Router, load: Callable[[str], RouterConfig] = load_config) -> None:
        self._path = path
        self._router = router
        self._load = load
        self._loaded = self._signature()
        self._seen = self._loaded

    async def reload(self) -> tuple[str, ...]:
        """Read the file and apply it.

        Returns:
            Notes about what could not be done.

        Raises:
            RouterConfigError: The file is not valid; nothing was changed.
        """
        self._loaded = self._seen = self._signature()
        config = self._load(self._path)
        if self._router.config.endpoints and not config.endpoints:
            raise RouterConfigError(
                "the file has no endpoints: it was truncated, or is being written. "
                "Nothing was changed; to remove all endpoints, stop the router",
                self._path,
            )
        notes = await self._router.apply(config)
        _log.info("%s: loaded again", self._path)
        for note in notes:
            _log.warning("%s: %s", self._path, note)
        return notes

    async def watch(self) -> None:
        """Reload the file whenever it changed, without end."""
        while True:
            await asyncio.sleep(WATCH_INTERVAL)
            await self.look()

    async def look(self) -> bool:
        """Reload the file if it changed and has been the same since the last look; return whether it did."""
        seen, self._seen = self._seen, self._signature()
        if self._seen is None or self._seen == self._loaded or self._seen != seen:
            return False
        await self.try_to_reload()
        return True

    async def try_to_reload(self) -> None:
        """Reload the file; an error is logged."""
        try:
            await self.reload()
        except MavstackError as error:
            _log.error("%s; the configuration in use stays", error)

    def _signature(self) -> Signature:
        try:
            found = Path(self._path).stat()
        except OSError:
            return None
        return found.st_mtime_ns, found.st_size, found.st_ino
