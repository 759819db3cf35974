"""Quality of service: the profiles of the rows, with the numbers that ROS 2 has for them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Qos:
    """A profile.

    Attributes:
        name: The word in tables.
        reliable: Lost samples are repeated.
        latched: A subscriber that joins late gets the last samples (TRANSIENT_LOCAL).
        depth: The number of samples that are kept.
    """

    name: str
    reliable: bool
    latched: bool
    depth: int

    def accepts(self, requested: Qos) -> bool:
        """Return whether a subscriber with the requested profile gets the samples of this one."""
        return (self.reliable or not requested.reliable) and (self.latched or not requested.latched)


#: Sensor data and setpoints: best effort, the last five samples.
SENSOR: Final = Qos("sensor", reliable=False, latched=False, depth=5)
#: States: reliable; a late subscriber gets the last ten samples.
STATE: Final = Qos("state", reliable=True, latched=True, depth=10)
#: A single value: reliable; a late subscriber gets the last sample.
LATCHED: Final = Qos("latched", reliable=True, latched=True, depth=1)
#: Everything else: reliable, the last ten samples.
DEFAULT: Final = Qos("default", reliable=True, latched=False, depth=10)
#: Events of ROS parameters: reliable, the last 1000 samples.
PARAMETERS: Final = Qos("parameters", reliable=True, latched=False, depth=1000)
#: Reliable, only the newest sample.
NEWEST: Final = Qos("newest", reliable=True, latched=False, depth=1)
#: Raw packets: best effort, the last 1000 samples.
PACKETS: Final = Qos("packets", reliable=False, latched=False, depth=1000)
#: Requests and replies: reliable.
SERVICES: Final = Qos("services", reliable=True, latched=False, depth=10)
