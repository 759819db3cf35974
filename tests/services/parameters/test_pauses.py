"""A list that pauses or is held up: to catch up with telemetry, by a full queue, by single requests."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING

import pytest

from mavstack.links import Impairment
from mavstack.services.parameters import ParameterServer
from mavstack.services.service import always_room
from tests.services.network import START, VEHICLE, HalfDuplexRadio
from tests.services.parameters.harness import ParameterHarness, table_of, values_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.service import HasRoom, Outgoing

COUNT = 955
#: When a list pauses, in seconds from its beginning.
PAUSES = (1.0, 2.5, 4.0)


class PausingServer(ParameterServer):
    """A server whose list pauses now and then, and takes turns with single values, which go on meanwhile."""

    pause = 0.0
    lists_turn = False

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        if self.resumes_at(now) is not None:
            yield from self._wanted_values(has_room)
            return
        while (outgoing := self._of_next_turn(now, has_room)) is not None:
            self.lists_turn = not self.lists_turn
            yield outgoing

    def _of_next_turn(self, now: float, has_room: HasRoom) -> Outgoing | None:
        reads = self._reads
        if self.lists_turn:
            self._reads = OrderedDict()
            outgoing = next(super().bulk_messages(now, has_room), None)
            self._reads = reads
            if outgoing is not None:
                return outgoing
        return next(super().bulk_messages(now, has_room), None)

    def resumes_at(self, now: float) -> float | None:
        ends = [START + begin + self.pause for begin in PAUSES if 0 <= now - START - begin < self.pause]
        return min(ends, default=None)


class PausingHarness(ParameterHarness):
    """A vehicle with such a server."""

    def __init__(self, pause: float, *arguments, **link) -> None:
        self.pause = pause
        super().__init__(*arguments, **link)

    def _setup(self, engine) -> None:
        self.server = engine.add(PausingServer(VEHICLE))
        self.server.pause = self.pause
        for name, value, kind in self.rows:
            self.server.add(name, value, kind)
        for begin in PAUSES:
            self.network.at(begin + self.pause, lambda: self.vehicle.engine.touch(self.server))


@pytest.mark.parametrize("pause", [0.15, 0.4, 1.0])
def test_a_list_that_pauses_is_not_download_twice(pause) -> None:
    harness = PausingHarness(pause, COUNT, radio=HalfDuplexRadio(5760.0), bandwidth=5760.0)
    listing = harness.client.download(harness.network.now)
    seconds = harness.run(listing)
    assert values_of(listing.result()) == table_of(harness.server)
    assert seconds < 1.05 * COUNT * 37 / 5760.0 + len(PAUSES) * pause
    assert sum(packet.name == "PARAM_REQUEST_READ" for packet in harness.vehicle.received) < COUNT / 4


class HeldUpServer(ParameterServer):
    """A server with turns of 20 ms: one single value if one is wanted, else twenty of the list."""

    turn_at = START
    turn = 0.02

    def bulk_messages(self, now: float, has_room: HasRoom = always_room) -> Iterator[Outgoing]:
        if now < self.turn_at:
            return
        maximum = 1 if self._reads else 20
        for _, outgoing in zip(range(maximum), super().bulk_messages(now, has_room), strict=False):
            yield outgoing
        self.turn_at = now + self.turn

    def next_timeout(self) -> float | None:
        return self.turn_at if self._reads or self._lists else None

    def handle_timeout(self, now: float) -> None:
        """Let bursts be as long as turns."""
        self._next_burst, self._left_in_burst = None, 32


class HeldUpHarness(ParameterHarness):
    """A vehicle with such a server."""

    def _setup(self, engine) -> None:
        self.server = engine.add(HeldUpServer(VEHICLE))
        for name, value, kind in self.rows:
            self.server.add(name, value, kind)


@pytest.mark.parametrize("seed", range(5))
def test_single_requests_do_not_hold_up_the_list(seed) -> None:
    harness = HeldUpHarness(COUNT, impairment=Impairment(latency=0.02, loss=0.1), seed=seed)
    listing = harness.client.download(harness.network.now)
    seconds = harness.run(listing)
    assert values_of(listing.result()) == table_of(harness.server)
    assert seconds < 5.0  # the list takes one second, a tenth of it singly two
