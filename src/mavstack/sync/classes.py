"""The blocking classes, by the names of the classes of the API that they wrap."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mavstack.vehicle.swarm  # noqa: F401 (defines the classes of the API, as does mavstack.vehicle)
from mavstack.node.api_object import api_classes

if TYPE_CHECKING:
    from collections.abc import Mapping


def wrapped_classes() -> Mapping[str, type]:
    """Return each class of the API, by its name."""
    return {kind.__name__: kind for kind in sorted(api_classes(), key=lambda kind: kind.__name__)}
