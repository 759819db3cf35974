"""Impairments as of real modems, by name: `udpout://127.0.0.1:14550?impairment=acoustic`.

Sound in water needs 0.67 s for a kilometre. Data sheets state rate and range, and no loss, since it depends
on echoes and waves: the loss is an example. Sources of the other values:

- `acoustic`: EvoLogics S2C R 18/34, data sheet: up to 13.9 kbit/s, range 3.5 km. Both directions share the
  water, so each has half of it; 0.35 s is 0.5 km.
- `acoustic-seatrac`: Blueprint SeaTrac X150: 100 bit/s, range 1 km, which sound passes in 0.65 s.
- `acoustic-m64`: Water Linked M64, waterlinked.com/underwater-communication: 64 bit/s in both directions,
  packets of 8 bytes in time slots, typical latency 0.5 s, range 200 m.
- `iridium`: short burst data of NAL Research (NetRef_SBD): 5 s for 70 bytes, 20 s for 1,960 bytes; the
  modem 9602 sends up to 340 bytes in a session, about ten seconds apart.
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
        "acoustic-m64": {"bandwidth": 8, "latency": 0.5, "jitter": 0.1, "loss": 0.05, "queue": 128},
        "acoustic-seatrac": {"bandwidth": 12.5, "latency": 0.65, "jitter": 0.05, "loss": 0.1, "queue": 128},
        "iridium": {"bandwidth": 34, "latency": 8.0, "jitter": 4.0, "loss": 0.02, "queue": 680},
    }
)
