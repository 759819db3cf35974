"""Impairments as of real modems, by name: `udpout://127.0.0.1:14550?impairment=acoustic`.

Bandwidths follow the data sheets: Water Linked M64 (64 bit/s), Blueprint SeaTrac X150 (100 bit/s), EvoLogics
S2C R 18/34 (6.9 kbit/s in bursts), Iridium short burst data (340 bytes in a session of about ten seconds).
Sound in water needs 0.67 s for a kilometre. Loss depends on echoes and waves; the values are examples.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

#: The values of `Impairment` of each modem: bandwidth in bytes per second, times in seconds.
PROFILES: Final[Mapping[str, Mapping[str, float]]] = MappingProxyType(
    {
        "acoustic": {"bandwidth": 860, "latency": 0.35, "jitter": 0.05, "loss": 0.1, "queue": 1024},
        "acoustic-m64": {"bandwidth": 8, "latency": 0.15, "jitter": 0.02, "loss": 0.05, "queue": 128},
        "acoustic-seatrac": {"bandwidth": 12.5, "latency": 0.65, "jitter": 0.05, "loss": 0.1, "queue": 128},
        "iridium": {"bandwidth": 34, "latency": 8.0, "jitter": 4.0, "loss": 0.02, "queue": 680},
    }
)
