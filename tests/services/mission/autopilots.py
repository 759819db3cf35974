"""Mission servers that behave like PX4 and ArduPilot where these differ from the guide.

Written from what their sources do, not from their code: PX4 has one transfer at a time for all types, passes
over items that it did not ask for and ends a download that asks out of turn; ArduPilot asks with the old
request, answers wrong items with INVALID_SEQUENCE, does not understand cancelling, and forgets an upload when
it ends.
"""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.services import Address, Service
from mavstack.services.mission import MissionItem, MissionServer

Result = common.MavMissionResult


class Autopilot(Service):
    handles = MissionServer.handles
    request_kind = common.MissionRequestInt
    ask_again = 0.25
    idle_timeout = 5.0

    def __init__(self, local: Address) -> None:
        super().__init__(local)
        self.plan: list[MissionItem] = []
        self.partner = Address(0, 0)
        self.receiving = self.sending = False
        self.items: list[MissionItem] = []
        self.count = self.due = 0
        self.requested_at = self.received_at = 0.0

    def receive(self, packet, now) -> None:
        source = Address(packet.system, packet.component)
        handler = getattr(self, f"on_{packet.name.lower()}", None)
        if handler:
            handler(packet.message, source, now)

    def next_timeout(self) -> float | None:
        if not self.receiving:
            return None
        return min(self.requested_at + self.ask_again, self.received_at + self.idle_timeout)

    def handle_timeout(self, now) -> None:
        if self.receiving and now >= self.received_at + self.idle_timeout:
            self.receiving = False
        elif self.receiving and now >= self.requested_at + self.ask_again:
            self.ask(now)

    def ask(self, now) -> None:
        self.requested_at = now
        self.send(self.request_kind(seq=len(self.items), **self.to()), self.partner)

    def ack(self, result: int, source: Address | None = None, plan_id: int = 0) -> None:
        message = common.MissionAck(type=result, opaque_id=plan_id, **self.to(source))
        self.send(message, source or self.partner)

    def to(self, source: Address | None = None) -> dict[str, int]:
        system, component = source or self.partner
        return {"target_system": system, "target_component": component}

    def begin(self, count: int, source: Address, now: float) -> None:
        self.partner, self.count, self.items = source, count, []
        self.receiving, self.received_at = True, now
        self.ask(now)

    def item_message(self, seq: int, source: Address) -> None:
        self.send(self.plan[seq].to_int(source, seq, 0), source)


class Px4(Autopilot):
    """PX4 v1.15."""

    done = 0

    def on_mission_count(self, message, source, now) -> None:
        if self.receiving and self.items:
            self.received_at = now
            self.ack(Result.ERROR, source)
        elif self.sending:
            self.ack(Result.ERROR, source)
        else:
            self.begin(message.count, source, now)

    def on_mission_item_int(self, message, source, now) -> None:
        if not self.receiving:
            again = message.seq + 1 == self.done
            self.ack(Result.ACCEPTED if again else Result.ERROR, source, 7 if again else 0)
            return
        self.received_at = now
        if message.seq != len(self.items):
            return
        self.items.append(MissionItem.read(message))
        self.done = len(self.items)
        if len(self.items) < self.count:
            self.ask(now)
        else:
            self.plan, self.receiving = self.items, False
            self.ack(Result.ACCEPTED, source, 7)

    def on_mission_request_list(self, message, source, now) -> None:
        if self.receiving:
            return
        self.sending, self.due, self.partner = True, 0, source
        self.send(common.MissionCount(count=len(self.plan), opaque_id=7, **self.to()), source)

    def on_mission_request_int(self, message, source, now) -> None:
        if not self.sending:
            return
        if message.seq == self.due < len(self.plan):
            self.due += 1
        elif message.seq != self.due - 1:
            self.sending = False
            self.ack(Result.ERROR, source)
            return
        self.item_message(message.seq, source)

    def on_mission_ack(self, message, source, now) -> None:
        self.sending = False
        if message.type == Result.OPERATION_CANCELLED:
            self.receiving = False


class ArduPilot(Autopilot):
    """ArduPilot 4.5; the item 0 that it puts home into is left out."""

    request_kind = common.MissionRequest
    ask_again = 1.0
    idle_timeout = 8.0

    def on_mission_count(self, message, source, now) -> None:
        self.plan = self.plan[: message.count]  # not atomic
        self.begin(message.count, source, now)

    def on_mission_item_int(self, message, source, now) -> None:
        if not self.receiving:
            self.ack(Result.ERROR, source)
        elif message.seq != len(self.items):
            self.ack(Result.INVALID_SEQUENCE, source)
        else:
            self.received_at = now
            self.items.append(MissionItem.read(message))
            self.plan[message.seq : message.seq + 1] = self.items[-1:]
            if len(self.items) < self.count:
                self.ask(now)
            else:
                self.receiving = False
                self.ack(Result.ACCEPTED, source)

    def on_mission_request_list(self, message, source, now) -> None:
        if self.receiving:
            self.ack(Result.DENIED, source)
        else:
            self.send(common.MissionCount(count=len(self.plan), **self.to(source)), source)

    def on_mission_request_int(self, message, source, now) -> None:
        if self.receiving:
            self.ack(Result.DENIED, source)
        elif message.seq >= len(self.plan):
            self.ack(Result.INVALID_SEQUENCE, source)
        else:
            self.item_message(message.seq, source)
