"""Setting up a key while each message of it is lost, repeated, delayed or the last one that arrives.

Whatever happens to a message, a key that the ground station holds must reach the vehicle afterwards. The
vehicle is one of ours, which tries a new key before it keeps it, or an autopilot, which changes at once.
"""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.security import SigningKey
from mavstack.services.signing_setup import SigningSetupServer
from mavstack.wire import Encoder
from tests.services.network import GROUND, VEHICLE, Pipe
from tests.services.signing_setup.harness import SigningHarness

OLD, NEW = SigningKey.from_passphrase("old"), SigningKey.from_passphrase("new")
FAULTS = ("lose", "duplicate", "delay", "cut", "silence")
DELAY, CUT = 4.0, 6.0
SILENCE = 60.0
#: Messages in each direction that are disturbed; a change without a disturbance has about ten.
MESSAGES = 14


class Disturbed(Pipe):
    """A direction of the link in which something happens to the packet of one number."""

    def __init__(self, pipe: Pipe, harness: Harness, number: int, fault: str) -> None:
        self.__dict__.update(pipe.__dict__)
        self._harness, self._number, self._fault = harness, number, fault
        self._sent = 0

    def send(self, data: bytes, now: float) -> None:
        self._sent += 1
        if self._sent - 1 != self._number:
            super().send(data, now)
            return
        network = self._harness.network
        match self._fault:
            case "duplicate":
                super().send(data, now)
                super().send(data, now)
                network.at(DELAY, lambda: Pipe.send(self, data, network.now))
            case "delay":
                network.at(DELAY, lambda: Pipe.send(self, data, network.now))
            case "cut":
                self.cut = True
                network.at(CUT, lambda: setattr(self, "cut", False))
            case "silence":  # this packet is the last one in both directions
                super().send(data, now)
                self._harness.cut_after(now)


class Harness(SigningHarness):
    """A vehicle and a ground station; `autopilot` makes the vehicle follow ArduPilot and PX4."""

    def __init__(self, old: SigningKey | None, *, autopilot: bool) -> None:
        self.autopilot = autopilot
        super().__init__(key=old)

    def setup_vehicle(self, engine) -> None:
        super().setup_vehicle(engine)
        if self.autopilot:
            engine.remove(self.server)
            self.server = engine.add(
                SigningSetupServer(VEHICLE, key=self.stored(), may_set=allow, as_autopilot=True)
            )

    def disturb(self, direction: int, number: int, fault: str) -> None:
        pipe = Disturbed(self.pipes[direction], self, number, fault)
        for port in (*self.ground.ports, *self.vehicle.ports):
            for side in ("outward", "inward"):
                if getattr(port, side) is self.pipes[direction]:
                    setattr(port, side, pipe)
        self.pipes = tuple(pipe if index == direction else each for index, each in enumerate(self.pipes))

    def cut_after(self, now: float) -> None:
        def cut(state: bool) -> None:
            for pipe in self.pipes:
                pipe.cut = state

        self.network.at(0.001, lambda: cut(True))
        self.network.at(SILENCE, lambda: cut(False))

    def keys_that_reach_the_vehicle(self, keys) -> list[SigningKey | None]:
        """Return the keys with which a new program on the ground gets an answer of the vehicle."""
        return [key for key in keys if self._is_answered(key)]

    def _is_answered(self, key: SigningKey | None) -> bool:
        encoder = Encoder(*GROUND, signing=None if key is None else key.signing())
        timesync = common.Timesync(tc1=0, ts1=77, target_system=1, target_component=1)
        now = self.network.now + 0.5  # after all packets that were sent
        (port,) = self.vehicle.ports
        return bool(self.vehicle.engine.receive(port.channel, encoder.encode(timesync, now), now))


def allow(request) -> None:
    """The policy that accepts every key."""


def check(old: SigningKey | None, new: SigningKey | None, direction, number, fault, *, autopilot) -> None:
    harness = Harness(old, autopilot=autopilot)
    harness.disturb(direction, number, fault)
    operation = harness.install(new)
    assert harness.network.run(lambda: operation.done, timeout=41.0)
    if operation.error is None:
        assert harness.server.key == new
    harness.network.run(timeout=SILENCE + 20.0)
    if harness.server.key is None:
        return  # a vehicle without a key accepts everything
    assert harness.keys_that_reach_the_vehicle([old, new]) == [harness.server.key]


def cases(step: int) -> list[tuple[int, int, str]]:
    """Every fault for every message of both directions, or one of `step` of them."""
    every = [(way, number, fault) for fault in FAULTS for way in (0, 1) for number in range(MESSAGES)]
    return every[::step]


@pytest.mark.parametrize("autopilot", [False, True], ids=["ours", "autopilot"])
@pytest.mark.parametrize(("old", "new"), [(None, NEW), (OLD, NEW), (OLD, None)])
def test_one_of_our_keys_reaches_the_vehicle_after_a_fault(old, new, autopilot):
    for case in cases(step=13):
        check(old, new, *case, autopilot=autopilot)


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("autopilot", [False, True], ids=["ours", "autopilot"])
@pytest.mark.parametrize(("old", "new"), [(None, NEW), (OLD, NEW), (OLD, None)])
def test_one_of_our_keys_reaches_the_vehicle_after_every_fault(old, new, autopilot):
    for case in cases(step=1):
        check(old, new, *case, autopilot=autopilot)
