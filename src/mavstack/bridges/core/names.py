"""The names of a vehicle's endpoints on a bus."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from mavstack.bridges.core.view import Frames
from mavstack.errors import InvalidArgumentError

#: The namespace of all endpoints, the same as in MAVROS.
ROOT: Final = "mavros"
#: The node of all endpoints except ROS parameters.
NODE: Final = "mavstack"
#: The node of the ROS parameters.
PARAMETER_NODE: Final = "param"
_NAME: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")


@dataclass(frozen=True, slots=True)
class VehicleNames:
    """The names of one vehicle.

    Attributes:
        prefix: The namespace before `/mavros`, such as "/uav1"; empty for the only vehicle.
    """

    prefix: str = ""

    @property
    def namespace(self) -> str:
        """The namespace of the rows, such as "/uav1/mavros"."""
        return f"{self.prefix}/{ROOT}"

    def full(self, name: str) -> str:
        """Return the full name of a row; one that begins with a slash is absolute."""
        return name if name.startswith("/") else f"{self.namespace}/{name}"

    def node(self, name: str = NODE) -> str:
        """Return the full name of a node, such as "/mavros/mavstack"."""
        return f"{self.namespace}/{name}"

    def frames(self) -> Frames:
        """Return the names of frames, with the prefix for one of several vehicles."""
        return Frames().prefixed(self.prefix.strip("/")) if self.prefix else Frames()


def checked_namespace(text: str) -> str:
    """Return a namespace with a slash before it and none behind; empty for none.

    Raises:
        InvalidArgumentError: It is not a name of ROS.
    """
    text = text.strip("/")
    if text and not _NAME.fullmatch(text):
        raise InvalidArgumentError(
            f"a namespace must have letters, digits and _, not begin with a digit, got {text!r:.60}"
        )
    return f"/{text}" if text else ""
