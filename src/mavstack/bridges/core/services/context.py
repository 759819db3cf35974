"""The state that the services of one vehicle share."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.mission import Plan


@dataclass(slots=True)
class ServiceContext:
    """The state of services between two requests.

    Attributes:
        publish: Publishes the values of a row that other parts make, by the name of the row.
        open_files: The files that are open, by path; the bytes of those that are written.
        plans: The last known plan of each type.
    """

    publish: Callable[[str, Any], None]
    open_files: dict[str, bytearray | None] = field(default_factory=dict)
    plans: dict[int, Plan] = field(default_factory=dict)
