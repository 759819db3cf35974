"""A peer controlled by the test: it sends messages to one service and collects the answers."""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING, Any

import mavstack
from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan, PlanType
from mavstack.wire import Packet
from tests.services.network import GROUND, START, VEHICLE

if TYPE_CHECKING:
    import builtins

    from mavstack.dialects import Message
    from mavstack.services import Address, Service

_sequence = count()


def waypoints(number: int, *, speed: float = 0.0) -> list[MissionItem]:
    return [
        MissionItem(
            common.MavCmd.NAV_WAYPOINT, speed, param5=47.0 + index / 1e4, param6=8.5, param7=float(index)
        )
        for index in range(number)
    ]


def plan_of(number: int, plan_type: int = PlanType.MISSION, *, speed: float = 0.0) -> Plan:
    return Plan.of(waypoints(number, speed=speed), plan_type)


class ScriptedPeer:
    """The peer of `service`, with the address `other`."""

    def __init__(self, service: Service, other: Address) -> None:
        self.service, self.other = service, other
        self.now = START

    def send(
        self, message: Message, *, source: Address | None = None, version: int = 2
    ) -> builtins.list[Any]:
        """Send `message` to the service; return its replies."""
        system, component = source or self.other
        raw = mavstack.encode(
            message, system=system, component=component, sequence=next(_sequence) % 256, version=version
        )
        return self.send_raw(raw)

    def send_raw(self, raw: bytes) -> builtins.list[Any]:
        self.service.receive(Packet(raw, common), self.now)
        return self.receive()

    def receive(self) -> builtins.list[Any]:
        """Return the messages that the service sends now."""
        return [outgoing.message for outgoing in self.service.messages_to_send(self.now)]

    def wait(self, seconds: float = 0.0) -> builtins.list[Any]:
        """Advance to the next timer, or by some seconds; return the messages sent then."""
        due = self.service.next_timeout()
        if seconds:
            self.now += seconds
        else:
            assert due is not None, "the service has no timer"
            self.now = max(self.now, due)
        self.service.handle_timeout(self.now)
        return self.receive()

    def wait_for_all(self, seconds: float) -> builtins.list[Any]:
        """Advance by `seconds`, timer by timer; return all messages sent."""
        end, messages = self.now + seconds, self.receive()
        while (due := self.service.next_timeout()) is not None and due <= end:
            messages += self.wait()
        self.now = end
        return messages


class ScriptedVehicle(ScriptedPeer):
    """A vehicle, for a client."""

    def __init__(self, service: Service) -> None:
        super().__init__(service, VEHICLE)

    def request(self, seq: int, kind: int = 0) -> builtins.list[Any]:
        return self.send(common.MissionRequestInt(seq=seq, mission_type=kind, **to_ground()))

    def ack(self, result: int, kind: int = 0, plan_id: int = 0) -> builtins.list[Any]:
        ack = common.MissionAck(type=result, mission_type=kind, opaque_id=plan_id, **to_ground())
        return self.send(ack)

    def count(self, number: int, kind: int = 0, plan_id: int = 0) -> builtins.list[Any]:
        count = common.MissionCount(count=number, mission_type=kind, opaque_id=plan_id, **to_ground())
        return self.send(count)

    def item(self, plan: Plan, seq: int) -> builtins.list[Any]:
        return self.send(plan.items[seq].to_int(GROUND, seq, plan.type))


class ScriptedStation(ScriptedPeer):
    """A ground station, for a server."""

    def __init__(self, service: Service) -> None:
        super().__init__(service, GROUND)

    def count(self, number: int, kind: int = 0, **other: object) -> builtins.list[Any]:
        return self.send(common.MissionCount(count=number, mission_type=kind, **to_vehicle()), **other)

    def item(self, plan: Plan, seq: int, **other: object) -> builtins.list[Any]:
        return self.send(plan.items[seq].to_int(VEHICLE, seq, plan.type), **other)

    def list(self, kind: int = 0, **other: object) -> builtins.list[Any]:
        return self.send(common.MissionRequestList(mission_type=kind, **to_vehicle()), **other)

    def request(self, seq: int, kind: int = 0, **other: object) -> builtins.list[Any]:
        return self.send(common.MissionRequestInt(seq=seq, mission_type=kind, **to_vehicle()), **other)

    def clear(self, kind: int = 0, **other: object) -> builtins.list[Any]:
        return self.send(common.MissionClearAll(mission_type=kind, **to_vehicle()), **other)

    def upload(self, plan: Plan) -> builtins.list[Any]:
        received = self.count(len(plan), plan.type)
        for seq in range(len(plan)):
            received = self.item(plan, seq)
        return received


def to_ground() -> dict[str, int]:
    return {"target_system": GROUND.system, "target_component": GROUND.component}


def to_vehicle() -> dict[str, int]:
    return {"target_system": VEHICLE.system, "target_component": VEHICLE.component}


def kinds(messages: list[Message]) -> list[str]:
    return [type(message).__name__ for message in messages]


def seqs(messages: list[Message]) -> list[int]:
    return [message.seq for message in messages]
