from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services import Address
from mavstack.services.system_time import Rebooted, SystemTimeBroadcaster, SystemTimeObserver, UnixTimeKnown
from tests.services.network import GROUND, START, VEHICLE, Network
from tests.services.single_service import feed_random_messages, packet_of, sent_by


def system_time(unix: float, boot: float) -> common.SystemTime:
    return common.SystemTime(time_unix_usec=round(unix * 1e6), time_boot_ms=round(boot * 1000))


def test_the_time_is_broadcast_at_its_interval() -> None:
    network = Network(keep_packets=True)
    vehicle = network.node(VEHICLE, lambda e: e.add(SystemTimeBroadcaster(VEHICLE, START, rate=2)))
    ground = network.node(GROUND)
    observer = ground.engine.add(SystemTimeObserver(GROUND))
    network.connect(ground, vehicle)
    network.run(timeout=10)
    assert len(ground.received) == 21
    clock = observer.clock_of(VEHICLE)
    assert clock.unix_time == pytest.approx(clock.received_at)
    assert clock.since_boot == pytest.approx(10.0)
    assert clock.offset == pytest.approx(0.0, abs=1e-5)


def test_a_clock_that_is_not_set_sends_0() -> None:
    broadcaster = SystemTimeBroadcaster(VEHICLE, START, unix_time=lambda _: None)
    assert sent_by(broadcaster, START + 2) == [common.SystemTime(time_unix_usec=0, time_boot_ms=2000)]


def test_the_time_since_boot_wraps() -> None:
    broadcaster = SystemTimeBroadcaster(VEHICLE, START)
    assert broadcaster.current_message(START + 4294968).time_boot_ms == 704


def test_without_room_it_waits_and_does_not_spin() -> None:
    broadcaster = SystemTimeBroadcaster(VEHICLE, START)
    assert list(broadcaster.messages_to_send(START, lambda *_: False)) == []
    assert broadcaster.next_timeout() > START
    broadcaster.handle_timeout(START + 5)
    assert len(sent_by(broadcaster, START + 5)) == 1
    assert sent_by(broadcaster, START + 5) == [], "what was left out is not made up for"


def test_a_rate_must_be_one() -> None:
    with pytest.raises(InvalidArgumentError):
        SystemTimeBroadcaster(VEHICLE, START, rate=0)


def test_a_time_of_0_is_not_known_and_one_after_a_fix_is_reported() -> None:
    observer = SystemTimeObserver(GROUND)
    observer.receive(packet_of(system_time(0, 5)), START)
    observer.receive(packet_of(system_time(86_400, 6)), START + 1)
    assert observer.clock_of(VEHICLE).unix_time is None
    assert observer.clock_of(VEHICLE).offset is None
    observer.receive(packet_of(system_time(START + 100, 7)), START + 2)
    observer.receive(packet_of(system_time(START + 101, 8)), START + 3)
    assert observer.events() == [UnixTimeKnown(VEHICLE, START + 100)]
    assert observer.clock_of(VEHICLE).offset == pytest.approx(98.0)


def test_a_reboot_is_reported_and_unsets_the_clock() -> None:
    observer = SystemTimeObserver(GROUND)
    observer.receive(packet_of(system_time(START, 500)), START)
    observer.receive(packet_of(system_time(0, 1)), START + 5)
    assert observer.events() == [UnixTimeKnown(VEHICLE, START), Rebooted(VEHICLE)]
    assert observer.clock_of(VEHICLE).unix_time is None


def test_systems_are_reported_apart_and_the_table_is_bounded() -> None:
    observer = SystemTimeObserver(GROUND)
    for number in range(600):
        source = Address(1 + number % 250, 1 + number // 250)
        observer.receive(packet_of(system_time(0, 1000 - number), source), START)
    assert observer.events() == []
    assert len(observer._clocks) == 256


@pytest.mark.parametrize("seed", range(20))
def test_garbage_never_raises(seed: int) -> None:
    feed_random_messages(SystemTimeObserver(GROUND), [common.SystemTime], seed)
