"""Messages between the members of a swarm: SWARM_STATE and SWARM_INTENT of the dialect in swarm.xml.

    exchange = Exchange(frame, system=1)
    node.send(exchange.state_message(own, time_boot_ms))
    exchange.receive(packet.system, packet.message, now)
    velocity = steer(own, exchange.neighbours(now), mission)

A companion computer on each vehicle sends both, and steers by those that it receives alone (`consensus`): no
member knows all others. Messages get lost and arrive late, so a position is carried on by its velocity, for
at most `MAX_EXTRAPOLATION` seconds, and a member counts for `NEIGHBOUR_TIMEOUT` seconds after its last
message.

The ids are 53000 and 53001. Ids up to 255 belong to MAVLink 1 and to official dialects: 156, which an article
on swarms proposes for its own message, is MOUNT_CONFIGURE of ardupilotmega, so an autopilot would decode a
position as a command to its gimbal. Signing, loss and limits of rate are those of the link, as for every
other message.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack.dialects import Dialect
from mavstack.errors import InvalidArgumentError
from mavstack.swarm.consensus import Neighbour

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.dialects import Message
    from mavstack.geodesy import LocalFrame
    from mavstack.swarm.arrays import Points
    from mavstack.swarm.barrier import Barrier

#: Seconds after the last message until a member is no longer a neighbour, and for which its position is
#: extrapolated.
NEIGHBOUR_TIMEOUT: Final = 3.0
MAX_EXTRAPOLATION: Final = 1.0
#: Maximum number of members in the table: the number of system ids of a network.
MAX_MEMBERS: Final = 255
#: The number of phases that SWARM_INTENT can distinguish.
_PHASES: Final = 256
#: The arrival in seconds of a member that should have arrived, and has not reported it.
_EARLIEST_ARRIVAL: Final = 0.1
_MAX_16: Final = 32_767
_STATE: Final = "SWARM_STATE"
_INTENT: Final = "SWARM_INTENT"


@dataclass(frozen=True, slots=True)
class Intent:
    """The next place of a member.

    Attributes:
        place: Metres north, east, up of the frame.
        arrival: Seconds until the arrival, 0 after it.
        phase: Number of the phase, 0 to 255.
    """

    place: Points
    arrival: float
    phase: int

    def has_passed(self, phase: int) -> bool:
        """Return whether a phase is over for the member; the number of the phase after 255 is 0."""
        later = (self.phase - phase) % _PHASES
        return self.arrival == 0.0 if not later else later < _PHASES / 2


def swarm_dialect() -> Dialect:
    """Return the dialect of the messages between members: common, and swarm.xml."""
    return Dialect.from_xml(files(__package__).joinpath("swarm.xml").read_text("utf-8"))


class Exchange:
    """The messages of one member, and what it received of the others.

    Args:
        frame: The frame of all positions; each member may have another one.
        system: The own system id, whose messages are ignored.
        swarm: Number of the swarm; messages of other swarms are ignored.
    """

    def __init__(self, frame: LocalFrame, system: int, *, swarm: int = 0) -> None:
        if not 0 <= swarm <= 255:
            raise InvalidArgumentError(f"swarm must be 0 to 255, got {swarm}")
        self._frame, self._system, self._swarm = frame, system, swarm
        self._dialect = swarm_dialect()
        self._states: dict[int, tuple[Neighbour, float]] = {}
        self._intents: dict[int, tuple[Intent, float]] = {}

    # Sending

    def state_message(self, own: Neighbour, time_boot_ms: int) -> Message:
        """Return SWARM_STATE of this member."""
        latitude, longitude, altitude = self._global(own.position)
        north, east, up = (_clamped(100.0 * each) for each in own.velocity)
        slot_north, slot_east, slot_up = (_clamped(10.0 * each) for each in own.slot)
        return self._class(_STATE)(
            time_boot_ms=time_boot_ms,
            lat=latitude,
            lon=longitude,
            alt=altitude,
            vx=north,
            vy=east,
            vz=-up,
            slot_north=slot_north,
            slot_east=slot_east,
            slot_up=slot_up,
            swarm=self._swarm,
        )

    def intent_message(self, intent: Intent, time_boot_ms: int) -> Message:
        """Return SWARM_INTENT of this member."""
        latitude, longitude, altitude = self._global(intent.place)
        return self._class(_INTENT)(
            time_boot_ms=time_boot_ms,
            lat=latitude,
            lon=longitude,
            alt=altitude,
            arrival=math.ceil(min(max(10.0 * intent.arrival, 0.0), 65_535.0)),
            phase=intent.phase,
            swarm=self._swarm,
        )

    # Receiving

    def receive(self, system: int, message: Message, now: float) -> bool:
        """Take a message of another component.

        Args:
            system: The system id of the sender.
            message: The message; all but those of the swarm are ignored.
            now: Seconds.

        Returns:
            True if it was one of another member of this swarm.
        """
        found: Any = message
        name = type(message).__name__
        if name not in ("SwarmState", "SwarmIntent") or system == self._system or found.swarm != self._swarm:
            return False
        known = self._states if name == "SwarmState" else self._intents
        if system not in known and len(known) >= MAX_MEMBERS:
            return False
        place = self._local(found)
        if name == "SwarmIntent":
            self._intents[system] = Intent(place, found.arrival / 10.0, found.phase), now
            return True
        velocity = np.array((found.vx, found.vy, -found.vz)) / 100.0
        slot = np.array((found.slot_north, found.slot_east, found.slot_up)) / 10.0
        self._states[system] = Neighbour(place, velocity, slot), now
        return True

    def members(self, now: float) -> Mapping[int, Neighbour]:
        """Return the members that are received, by system id, where they are now."""
        return {
            system: Neighbour(
                state.position + min(max(now - at, 0.0), MAX_EXTRAPOLATION) * state.velocity,
                state.velocity,
                state.slot,
            )
            for system, (state, at) in self._states.items()
            if now - at <= NEIGHBOUR_TIMEOUT
        }

    def neighbours(self, now: float) -> list[Neighbour]:
        """Return the members that are received, for `consensus.steer`."""
        return list(self.members(now).values())

    def intents(self, now: float) -> Mapping[int, Intent]:
        """Return the next places of the members that are received, by system id."""
        return {
            # A member that did not report its arrival yet may be late.
            system: Intent(
                intent.place,
                max(intent.arrival - (now - at), _EARLIEST_ARRIVAL) if intent.arrival else 0.0,
                intent.phase,
            )
            for system, (intent, at) in self._intents.items()
            if now - at <= NEIGHBOUR_TIMEOUT
        }

    def report_arrivals(self, barrier: Barrier, phase: int, now: float) -> None:
        """Let the members arrive at a barrier that reported the end of a phase, or are in a later one.

        Args:
            barrier: The barrier at the end of the phase.
            phase: Number of the phase.
            now: Seconds.
        """
        for system, intent in self.intents(now).items():
            if intent.has_passed(phase):
                barrier.arrive(system)

    def _class(self, name: str) -> Callable[..., Message]:
        return self._dialect[name]

    def _global(self, place: Points) -> tuple[int, int, int]:
        if not np.isfinite(place).all():
            raise InvalidArgumentError("the position of a member must be finite")
        latitude, longitude, altitude = self._frame.to_global(
            float(place[0]), float(place[1]), -float(place[2])
        )
        return round(latitude * 1e7), round(longitude * 1e7), round(altitude * 1e3)

    def _local(self, message: Any) -> Points:  # noqa: ANN401 (of a dialect that is read at run time)
        north, east, down = self._frame.to_local(message.lat / 1e7, message.lon / 1e7, message.alt / 1e3)
        return np.array((north, east, -down))


def _clamped(value: float) -> int:
    return round(min(max(value, -_MAX_16), _MAX_16)) if math.isfinite(value) else 0
