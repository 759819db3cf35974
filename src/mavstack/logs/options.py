"""The options with which a log is opened; a format uses those that concern it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from mavstack.dialects import Dialect

if TYPE_CHECKING:
    from typing import Protocol

    class HasDialect(Protocol):
        """A `Dialect`, or a dialect module such as `mavstack.dialects.common`."""

        @property
        def dialect(self) -> Dialect:
            """The dialect."""


@dataclass(frozen=True)
class OpenOptions:
    """The options of `open_log`.

    Attributes:
        dialect_choice: The dialect of packets, as a `Dialect`, a dialect module or a name.
        timestamped: True for a tlog, False for a raw stream; None detects it from the content.
        thread_limit: Maximum number of threads; 0 for one per processor.
    """

    dialect_choice: HasDialect | str = "all"
    timestamped: bool | None = None
    thread_limit: int = 0

    @cached_property
    def dialect(self) -> Dialect:
        """The dialect, loaded when a format asks for it."""
        choice = self.dialect_choice
        return Dialect.load(choice) if isinstance(choice, str) else choice.dialect

    @property
    def threads(self) -> int:
        """Maximum number of threads, at least 1."""
        return self.thread_limit or os.cpu_count() or 1
