"""Who a client of the station may be on the network, beside what its role may send (see `security.roles`).

The ids in a packet are those that its sender writes, so a client could speak in the name of a vehicle or of
another ground station. An administrator may, for its packets can be those of a bridge. All others must not
use the system id of a vehicle, and their heartbeats must not be those of an autopilot.

A client that observes needs still less. It sends no heartbeat, for the station sends one, no packets in the
name of another component, and nothing of the mission protocol, for its MISSION_ACK would end the transfer of
a pilot. The API downloads plans for it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.security.roles import Role, allows
from mavstack.services import message_ids

if TYPE_CHECKING:
    from mavstack.vehicle import Connection
    from mavstack.wire import Packet

_HEARTBEAT: Final = next(iter(message_ids(common.Heartbeat)))
#: Messages of observing clients that `roles` allows, but the station refuses.
_NOT_OBSERVED: Final = message_ids(
    common.Heartbeat,
    common.MissionRequestList,
    common.MissionRequest,
    common.MissionRequestInt,
    common.MissionAck,
)


def may_send(role: Role, message_id: int, command: int | None = None) -> bool:
    """Return whether a client may have the station send a message, from the station's own address.

    Args:
        role: The role of the client.
        message_id: The id of the message. A heartbeat needs `ADMINISTER`: the station sends its own.
        command: The MAV_CMD of a command or a mission item; None for other messages.

    Returns:
        True if it may.
    """
    if role is Role.ADMINISTER:
        return True
    barred = message_id == _HEARTBEAT or (role is Role.OBSERVE and message_id in _NOT_OBSERVED)
    return not barred and allows(role, message_id, command)


class SenderRules:
    """The rules for raw packets of one client, whose messages its role allows.

    Args:
        connection: The connection over which the packets are sent.
        role: The role of the client.
    """

    def __init__(self, connection: Connection, role: Role) -> None:
        self._connection = connection
        self._role = role

    def allow(self, packet: Packet) -> bool:
        """Return whether a packet may be sent with its ids."""
        if self._role is Role.ADMINISTER:
            return True
        if packet.system in self._connection.vehicles:
            return False
        if self._role is Role.OBSERVE:
            return packet.message_id not in _NOT_OBSERVED and not self._is_another(packet)
        return packet.message_id != _HEARTBEAT or packet.message.autopilot == common.MavAutopilot.INVALID

    def _is_another(self, packet: Packet) -> bool:
        return (packet.system, packet.component) in self._connection.components
