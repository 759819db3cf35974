"""Durations of transfers of 200 items, in virtual seconds, compared with the link's capacity."""

from __future__ import annotations

from statistics import median

from mavstack.links import Impairment
from mavstack.services.mission import MissionClient, MissionServer
from tests.services.mission.scripted_peer import plan_of
from tests.services.network import GROUND, VEHICLE, HalfDuplexRadio, Network

ITEMS = 200


def transfer(seed: int, impairment: Impairment | None = None, **wire) -> tuple[float, float]:
    """Seconds up and down; both ends equal."""
    network = Network(seed)
    ground, vehicle = network.node(GROUND), network.node(VEHICLE)
    client = ground.engine.add(MissionClient(GROUND, VEHICLE))
    server = vehicle.engine.add(MissionServer(VEHICLE))
    network.connect(ground, vehicle, impairment, **wire)
    plan, begin = plan_of(ITEMS), network.now
    upload = client.upload(plan, begin)
    ground.engine.touch(client)
    assert network.run(lambda: upload.done)
    assert upload.result() == server.plan(plan.type) == plan
    middle = network.now
    download = client.download(middle)
    ground.engine.touch(client)
    assert network.run(lambda: download.done)
    assert download.result() == plan
    return middle - begin, network.now - middle


def medians(impairment: Impairment, seeds: int) -> tuple[float, float]:
    times = [transfer(seed, impairment) for seed in range(seeds)]
    up, down = median(time[0] for time in times), median(time[1] for time in times)
    print(f"{ITEMS} items, {impairment}: up {up:.2f} s, down {down:.2f} s")
    return up, down


def test_clean_link_takes_no_time() -> None:
    up, down = transfer(0)
    assert up + down < 0.01


def test_20_ms_and_10_percent_loss() -> None:
    """One item in flight takes 8 s without any loss."""
    up, down = medians(Impairment(latency=0.02, loss=0.1), 11)
    assert up <= 9.5
    assert down <= 12.0


def test_20_ms_and_1_percent_loss() -> None:
    up, down = medians(Impairment(latency=0.02, loss=0.01), 5)
    assert up <= 8.3
    assert down <= 8.5


def test_half_duplex_radio_is_used_to_its_end() -> None:
    for bandwidth in (None, 5760.0):
        radio = HalfDuplexRadio(bandwidth=5760.0, latency=0.0)
        up, down = transfer(0, radio=radio, bandwidth=bandwidth)
        minimum = radio.carried / radio.bandwidth
        print(f"{ITEMS} items, radio: up {up:.2f} s, down {down:.2f} s, minimum {minimum / 2:.2f} s")
        assert up + down <= 1.05 * minimum
        assert radio.overflowed == 0
        assert max(up, down) <= 2.9
