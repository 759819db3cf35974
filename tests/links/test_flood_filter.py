"""The filter in the kernel that thins out the senders of a flood."""

from __future__ import annotations

import select
import socket
import sys
from contextlib import ExitStack

import pytest

from mavstack.links.flood_filter import FIRST_PART, MAX_SENDERS, MIN_PART, FloodFilter

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="Linux only")
COUNT = 1000
#: Seconds after which a loaded system delivers what was sent at the latest.
LATE = 0.3


@pytest.fixture(params=["127.0.0.1", "::1"])
def sockets(request):
    """A receiver, an attacker and a vehicle."""
    family = socket.AF_INET6 if ":" in request.param else socket.AF_INET
    with ExitStack() as stack:
        opened = [stack.enter_context(socket.socket(family, socket.SOCK_DGRAM)) for _ in range(3)]
        for each in opened:
            try:
                each.bind((request.param, 0))
            except OSError:
                pytest.skip("no IPv6")
        opened[0].setblocking(False)
        opened[0].setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        yield opened


def received(receiver, sender, count: int) -> int:
    """Send datagrams in small groups; return how many are received."""
    total = 0
    for number in range(count):
        sender.sendto(b"x", receiver.getsockname())
        if number % 50 == 49:
            total += taken(receiver)
    total += taken(receiver)
    while total < count and select.select([receiver], [], [], LATE)[0]:
        total += taken(receiver)
    return total


def taken(receiver) -> int:
    """Return how many datagrams wait, and take them."""
    count = 0
    try:
        while receiver.recv(16):
            count += 1
    except BlockingIOError:
        pass
    return count


def flooded(receiver, attacker, vehicle, times: int = 1) -> FloodFilter:
    flood_filter = FloodFilter(receiver)
    for _ in range(times):
        flood_filter.observe([attacker.getsockname()] * 100 + [vehicle.getsockname()], emptied=False)
        flood_filter.adjust(overflowed=True)
    return flood_filter


def test_only_the_sender_of_a_flood_loses_datagrams(sockets):
    receiver, attacker, vehicle = sockets
    flood_filter = flooded(*sockets)
    assert flood_filter.active
    assert 0.3 * FIRST_PART * COUNT < received(receiver, attacker, COUNT) < 3 * FIRST_PART * COUNT
    assert received(receiver, vehicle, COUNT) == COUNT
    with socket.socket(receiver.family, socket.SOCK_DGRAM) as other:
        assert received(receiver, other, COUNT) == COUNT


def test_the_part_that_passes_shrinks_while_the_queue_cannot_be_emptied_and_then_grows(sockets):
    receiver, attacker, _ = sockets
    flood_filter = flooded(*sockets, times=30)
    assert received(receiver, attacker, COUNT) <= 30 * MIN_PART * COUNT
    turns = 0
    while flood_filter.active:
        flood_filter.observe([], emptied=True)
        flood_filter.adjust(overflowed=False)
        turns += 1
    assert 50 < turns < 150
    assert received(receiver, attacker, COUNT) == COUNT


def test_a_queue_that_loses_nothing_is_not_filtered(sockets):
    receiver, attacker, _ = sockets
    flood_filter = FloodFilter(receiver)
    for emptied, overflowed in ((False, False), (True, True)):
        flood_filter.observe([attacker.getsockname()] * 100, emptied=emptied)
        flood_filter.adjust(overflowed=overflowed)
        assert not flood_filter.active


def test_the_senders_in_the_filter_are_bounded():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.setblocking(False)
        flood_filter = FloodFilter(receiver)
        for round_ in range(3):
            ports = range(1000 * round_ + 2000, 1000 * round_ + 3000)
            flood_filter.observe([("127.0.0.1", port) for port in ports] * 9, emptied=False)
            flood_filter.adjust(overflowed=True)
            assert len(flood_filter._senders) == MAX_SENDERS
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
            assert received(receiver, other, 100) == 100


def test_a_system_that_refuses_the_filter_goes_without(sockets):
    receiver, attacker, vehicle = sockets
    receiver.close()
    flood_filter = FloodFilter(receiver)
    flood_filter.observe([attacker.getsockname()] * 100 + [vehicle.getsockname()], emptied=False)
    flood_filter.adjust(overflowed=True)
    assert not flood_filter.active
