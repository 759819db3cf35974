from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError, LinkURLError
from mavstack.links import Flow, Impairment
from mavstack.links.impairment_profiles import PROFILES
from mavstack.links.options import Options
from mavstack.links.url import parse_url

chance = st.floats(0, 1)
impairments = st.builds(
    Impairment,
    loss=chance, duplicate=chance, reorder=chance, corrupt=chance,
    latency=st.floats(0, 2), jitter=st.floats(0, 2), hold=st.floats(0, 1),
    bandwidth=st.sampled_from([0, 100, 5760, 1e6]), queue=st.integers(0, 10_000), seed=st.integers(0, 2**63),
)  # fmt: skip
traffic = st.lists(st.tuples(st.floats(0, 0.5), st.binary(min_size=1, max_size=300)), max_size=40)


def run(impairment: Impairment, chunks: list[tuple[float, bytes]]) -> tuple[list[tuple[float, bytes]], Flow]:
    """Send chunks, each with a pause in seconds before it; return the arrivals with their times."""
    flow, now, arrived = Flow(impairment), 0.0, []

    def advance(until: float) -> None:
        while (due := flow.next_timeout()) is not None and due <= until:
            arrived.extend((due, data) for data in flow.receive(due))

    for pause, data in chunks:
        now += pause
        advance(now)
        flow.send(data, now)
    advance(float("inf"))
    return arrived, flow


@given(impairments, traffic)
def test_the_same_seed_gives_the_same_result(impairment, chunks):
    first, flow = run(impairment, chunks)
    second, again = run(impairment, chunks)
    assert first == second
    assert flow.stats == again.stats


@given(impairments, traffic)
def test_every_chunk_is_counted(impairment, chunks):
    arrived, flow = run(impairment, chunks)
    stats = flow.stats
    assert stats.sent == len(chunks)
    assert stats.delivered == len(arrived)
    assert stats.sent + stats.duplicated == stats.delivered + stats.lost + stats.overflowed
    assert [at for at, _ in arrived] == sorted(at for at, _ in arrived)


@given(traffic)
def test_a_perfect_flow_changes_nothing(chunks):
    arrived, _ = run(Impairment(), chunks)
    assert [data for _, data in arrived] == [data for _, data in chunks]


@given(traffic, st.floats(0, 1), st.floats(0, 1))
def test_without_reordering_jitter_keeps_the_order(chunks, latency, jitter):
    arrived, _ = run(Impairment(latency=latency, jitter=jitter, seed=4), chunks)
    assert [data for _, data in arrived] == [data for _, data in chunks]


@pytest.mark.parametrize("name", ["loss", "duplicate", "reorder"])
@pytest.mark.parametrize("probability", [0.0, 0.1, 0.5, 1.0])
def test_probabilities_are_met_over_many_chunks(name, probability):
    count = 5000
    _, flow = run(Impairment(**{name: probability}, seed=11), [(0.001, b"x")] * count)
    stats = flow.stats
    happened = {"loss": stats.lost, "duplicate": stats.duplicated, "reorder": stats.reordered}[name]
    assert happened / count == pytest.approx(probability, abs=0.02)


def test_reordered_chunks_are_overtaken_by_later_ones():
    arrived, _ = run(Impairment(reorder=0.2, hold=0.1, seed=2), [(0.01, bytes([n])) for n in range(200)])
    order = [data[0] for _, data in arrived]
    assert order != sorted(order)
    assert sorted(order) == list(range(200))


@pytest.mark.parametrize("probability", [0.001, 0.1, 1.0])
def test_bytes_are_corrupted_with_the_given_probability(probability):
    arrived, flow = run(Impairment(corrupt=probability, seed=5), [(0.0, bytes(1000))] * 200)
    changed = sum(1000 - data.count(0) for _, data in arrived)
    assert changed / 200_000 == pytest.approx(probability, rel=0.2)
    assert flow.stats.corrupted == sum(data != bytes(1000) for _, data in arrived)


@given(traffic, st.sampled_from([500, 5760]), st.integers(0, 3000))
def test_the_bandwidth_is_never_exceeded_and_the_queue_is_bounded(chunks, bandwidth, queue):
    arrived, _ = run(Impairment(bandwidth=bandwidth, queue=queue), chunks)
    total = 0
    for at, data in arrived:
        total += len(data)
        assert total <= bandwidth * at + 1e-6
    last = sum(pause for pause, _ in chunks)
    largest = max((len(data) for _, data in chunks), default=0)
    assert all(at <= last + (queue + largest) / bandwidth + 1e-6 for at, _ in arrived)


def test_a_full_queue_refuses_chunks():
    flow = Flow(Impairment(bandwidth=1000, queue=1000))
    accepted = [flow.send(bytes(100), 0.0) for _ in range(20)]
    assert accepted == [True] * 10 + [False] * 10
    assert flow.stats.overflowed == 10
    assert flow.send(bytes(100), 0.5)


def test_delays_are_within_latency_and_jitter():
    arrived, _ = run(Impairment(latency=0.2, jitter=0.05, seed=1), [(1.0, bytes([n])) for n in range(100)])
    delays = [at - (data[0] + 1) for at, data in arrived]
    assert min(delays) >= 0.15 - 1e-9
    assert max(delays) <= 0.25 + 1e-9
    assert max(delays) - min(delays) > 0.05


def test_two_flows_of_one_seed_differ():
    impairment = Impairment(loss=0.5, seed=1)
    one, two = Flow(impairment, "0 out"), Flow(impairment, "0 in")
    for flow in (one, two):
        for number in range(50):
            flow.send(bytes([number]), 0.0)
    assert one.receive(0.0) != two.receive(0.0)


def test_url_options():
    url = "udpout://h:1?loss=10%25&latency=200ms&jitter=20ms&bandwidth=5760&reorder=0.1&corrupt=1e-4&queue=4k&seed=7"
    expected = Impairment(
        loss=0.1, latency=0.2, jitter=0.02, bandwidth=5760, reorder=0.1, corrupt=1e-4, queue=4096, seed=7
    )
    assert Impairment.from_options(Options(parse_url(url))) == expected
    assert Impairment.from_options(Options(parse_url("udpout://h:1"))) is None


@pytest.mark.parametrize(
    "wrong", [{"loss": 1.5}, {"corrupt": -0.1}, {"latency": -1}, {"bandwidth": float("inf")}]
)
def test_values_out_of_range_are_refused(wrong):
    with pytest.raises(InvalidArgumentError, match="must be"):
        Impairment(**wrong)


def test_modems_by_name():
    acoustic = Impairment.from_options(
        Options(parse_url("udpout://127.0.0.1:1?impairment=acoustic&loss=0.5"))
    )
    assert (acoustic.bandwidth, acoustic.latency, acoustic.loss) == (860, 0.35, 0.5)
    for name in PROFILES:
        model = Impairment.from_options(
            Options(parse_url(f"udpout://127.0.0.1:1?impairment={name}&jitter=0s&loss=0"))
        )
        ((arrival, _),), _ = run(model, [(0.0, bytes(54))])
        assert arrival == pytest.approx(54 / model.bandwidth + model.latency)
    with pytest.raises(LinkURLError, match="acoustic"):
        Impairment.from_options(Options(parse_url("udpout://127.0.0.1:1?impairment=pigeon")))
