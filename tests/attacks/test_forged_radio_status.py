"""Forged RADIO_STATUS with a full queue must not throttle a shared channel for long."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.node.engine import Engine
from mavstack.node.pacing import DEFAULT_ESTIMATE, ESTIMATE_TIMEOUT, MIN_ESTIMATE
from mavstack.security import SigningKey
from mavstack.services import Address, Priority
from mavstack.wire import encode
from tests.services.network import GROUND, START

VEHICLE, SIK, BRIDGE = Address(1, 1), Address(51, 68), Address(1, 240)
FULL = common.RadioStatus(txbuf=0, remrssi=100, rssi=100)


class Channel:
    """A channel of a ground station that several programs share."""

    def __init__(self) -> None:
        self.engine = Engine(GROUND)
        self.state = self.engine.open_channel("udpin 10.0.0.255:14550")

    def receive(self, source: Address, now: float, message=FULL) -> None:
        data = encode(message, system=source.system, component=source.component)
        self.engine.receive(self.state, data, now)

    def bytes_sent(self, now: float, seconds: float) -> int:
        """Send bulk as fast as the pacer allows, and return the bytes."""
        sent = 0
        for step in range(round(seconds * 100)):
            at = now + step / 100
            while self.state.pacer.has_room(Priority.BULK, at) and sent < 1_000_000:
                self.state.pacer.sent(280, at, Priority.BULK)
                sent += 280
        return sent


@pytest.mark.parametrize("source", [VEHICLE, Address(255, 190), Address(7, 154), Address(200, 200)])
def test_only_radios_throttle(source):
    channel = Channel()
    for number in range(100):
        channel.receive(source, START + number)
    assert channel.state.pacer.bandwidth is None
    assert channel.bytes_sent(START + 100, 1.0) > 100_000


@pytest.mark.parametrize("source", [SIK, BRIDGE, Address(255, 68)])
def test_a_radio_throttles(source):
    channel = Channel()
    for number in range(30):
        channel.receive(source, START + number)
    assert channel.state.pacer.bandwidth == MIN_ESTIMATE


def test_a_throttle_ages():
    channel = Channel()
    for number in range(30):
        channel.receive(SIK, START + number)
        channel.bytes_sent(START + number, 0.5)
    assert channel.bytes_sent(START + 30, 1.0) < 1000
    assert channel.bytes_sent(START + 29 + ESTIMATE_TIMEOUT, 1.0) > 100_000
    assert not channel.state.pacer.learned
    channel.receive(SIK, START + 100, common.RadioStatus(txbuf=60))  # a radio is learned again
    assert channel.state.pacer.learned


def test_a_burst_of_reports_counts_as_one():
    channel = Channel()
    for number in range(1000):
        channel.receive(SIK, START + number / 100_000)
    assert channel.state.pacer.bandwidth > 1000


def test_a_bandwidth_of_the_url_is_never_forgotten():
    channel = Engine(GROUND).open_channel("radio", bandwidth=5000)
    channel.pacer.radio_status(0, START)
    channel.pacer.sent(100, START + 1000)
    assert channel.pacer.bandwidth == 5000


def test_a_radio_with_an_empty_queue_ends_a_forged_throttle():
    channel = Channel()
    for number in range(30):
        channel.receive(SIK, START + number)
    assert channel.state.pacer.bandwidth == MIN_ESTIMATE
    for number in range(30, 60):  # the radio's own reports continue, and nothing uses the bandwidth
        channel.receive(SIK, START + number, common.RadioStatus(txbuf=100, remrssi=100, rssi=100))
    assert channel.state.pacer.bandwidth >= DEFAULT_ESTIMATE


def test_an_unsigned_report_changes_nothing_on_a_link_that_signs():
    engine = Engine(GROUND)
    signing = SigningKey.from_passphrase("field").signing(accept_unsigned=True)
    state = engine.open_channel("udpin 10.0.0.255:14550", signing=signing)
    for number in range(30):
        engine.receive(state, encode(FULL, system=SIK.system, component=SIK.component), START + number)
    assert state.pacer.bandwidth is None
