from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.security.sealed import SealConfig, messages, responder, tunnel
from mavstack.security.sealed.keys import public_key

from .network import SHARED, Network

ONE, TWO = bytes([1] * 32), bytes([2] * 32)
PINNED = (
    SealConfig.pinned(ONE, {public_key(TWO): "ground"}),
    SealConfig.pinned(TWO, {public_key(ONE): "boat"}),
)


def connected(seed: int = 0, configs=(SHARED, SHARED), **conditions) -> Network:
    network = Network(seed, **conditions)
    network.ends = [network.client(configs[0]), network.server(configs[1])]
    network.run(1.0)
    return network


def exchange(network: Network, content: bytes = b"hello") -> None:
    """Check that both directions work."""
    for sender in (0, 1):
        network.received[1 - sender].clear()
        assert network.write(sender, content)
        network.run(0.5)
        assert network.received[1 - sender] == [content]


@pytest.mark.parametrize("hybrid", [False, True])
@pytest.mark.parametrize("aes", [False, True])
def test_a_shared_key(hybrid, aes):
    config = SealConfig.shared(bytes(32), hybrid=hybrid, aes=aes)
    exchange(connected(configs=(config, config)))


@pytest.mark.parametrize("hybrid", [False, True])
def test_pinned_keys_name_the_peers(hybrid):
    configs = (
        SealConfig.pinned(ONE, {public_key(TWO): "ground"}, hybrid=hybrid),
        SealConfig.pinned(TWO, {public_key(ONE): "boat", bytes(32): "other"}, hybrid=hybrid),
    )
    network = connected(configs=configs)
    exchange(network)
    assert [end.peer for end in network.ends] == ["ground", "boat"]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (SHARED, SealConfig.shared(ONE)),
        (SHARED, SealConfig.shared(bytes(32), hybrid=True)),
        (SealConfig.shared(bytes(32), hybrid=True), SHARED),
        (SHARED, SealConfig.shared(bytes(32), aes=True)),
        (SHARED, PINNED[1]),
        (PINNED[0], SealConfig.pinned(TWO, {public_key(bytes([3] * 32)): "other"})),
        (SealConfig.pinned(ONE, {public_key(bytes([3] * 32)): "other"}), PINNED[1]),
    ],
)
def test_ends_with_other_keys_or_algorithms_never_meet(one, other):
    network = connected(configs=(one, other))
    network.run(10.0)
    assert not any(end.is_open for end in network.ends)
    assert sum(network.ends[1]._responder.refusals.values())


def test_the_algorithms_cannot_be_lowered_on_the_way():
    hybrid = SealConfig.shared(bytes(32), hybrid=True)
    network = Network()
    network.ends = [network.client(hybrid), network.server(SHARED)]
    original = network.send

    def lowered(sender: int, datagram: bytes) -> None:
        if datagram[0] in (messages.HELLO, messages.INITIATE):
            datagram = datagram[:2] + bytes((0,)) + datagram[3:]
        original(sender, datagram)

    network.send = lowered
    network.run(10.0)
    assert not any(end.is_open for end in network.ends)
    assert network.ends[1]._responder.refusals["forged or unknown key"]


@settings(max_examples=10)
@given(st.integers(0, 2**32))
def test_a_bad_network_loses_duplicates_and_reorders_but_nothing_arrives_twice(seed):
    network = connected(seed, loss=0.3, duplicate=0.2, jitter=0.3)
    while not all(end.is_open for end in network.ends):
        assert network.now < 240
        network.run(1.0)
    sent = [b"%d" % number for number in range(100)]
    for content in sent:
        network.write(0, content)
        network.run(0.02, 0.02)
    network.run(1.0)
    received = network.received[1]
    assert len(set(received)) == len(received) >= 30
    assert set(received) <= set(sent)


def test_nothing_recorded_is_accepted_again():
    network = connected()
    exchange(network)
    recorded = list(network.recorded)
    for receiver, datagram in recorded * 2:
        network.inject(receiver, datagram)
    network.received[0].clear()
    network.received[1].clear()
    network.run(1.0)
    assert network.received == ([], [])
    exchange(network)
    network.ends[1] = network.server()  # nor by the next run
    for receiver, datagram in recorded:
        network.inject(receiver, datagram)
    network.run(0.1)
    assert network.received[1] == [b"hello"] * (network.received[1] != [])
    assert not network.ends[1].is_open


@pytest.mark.parametrize("end", [0, 1])
def test_a_restarted_end_is_reached_within_seconds(end):
    network = connected()
    network.ends[end] = network.client() if end == 0 else network.server()
    network.run(3.5)
    exchange(network)


def test_new_keys_every_two_minutes_without_a_gap():
    network = connected()
    first = network.ends[0]._current
    for number in range(260):
        assert network.write(0, b"%d" % number)
        assert network.write(1, b"%d" % number)
        network.run(1.0, 0.25)
    assert len(network.received[0]) == len(network.received[1]) == 260
    assert network.ends[0]._current is not first
    assert sum(data[0] == messages.INITIATE for _, data in network.recorded) == 3


def test_new_keys_after_many_frames():
    network = connected()
    first = network.ends[0]._current
    first.sent = tunnel.REKEY_FRAMES
    network.run(3.0)
    assert network.ends[0]._current is not first
    exchange(network)


def test_a_session_that_could_not_be_renewed_expires():
    network = connected()
    network.loss = 1.0
    network.run(tunnel.EXPIRE_SECONDS + 1, 0.5)
    assert not any(end.is_open for end in network.ends)
    network.loss = 0.0
    network.run(6.0)
    exchange(network)


@pytest.mark.parametrize("seed", range(5))
def test_both_ends_of_a_serial_link_begin(seed):
    network = Network(seed, delay=0.2)
    network.ends = [network.both(), network.both()]
    network.run(3.0)
    exchange(network)
    network.run(300.0)  # two renewals
    exchange(network)
    network.ends[seed % 2] = network.both()
    network.run(8.0)
    exchange(network)


def test_own_messages_sent_back_make_no_session():
    network = Network()
    network.ends = [network.both(), network.both()]
    network.send = lambda sender, datagram: network.inject(sender, datagram, 0.01)
    network.run(20.0)
    assert not any(end.is_open for end in network.ends)
    assert network.ends[0].refusals["reflected"]


def test_a_silent_link_stays_open_by_empty_frames():
    network = connected()
    before = len(network.recorded)
    network.run(60.0)
    sent = [data for _, data in network.recorded[before:]]
    assert all(len(data) == 20 for data in sent)
    assert 50 <= len(sent) <= 62
    exchange(network)


def test_a_slow_link_whose_answers_take_seconds():
    network = Network(delay=2.5)
    network.ends = [network.client(), network.server()]
    network.run(20.0)
    assert all(end.is_open for end in network.ends)


def test_a_flood_of_hellos_costs_no_memory_and_no_larger_answers():
    network = connected()
    server = network.ends[1]
    for number in range(1000):
        server.receive(messages.hello(SHARED.suite, number.to_bytes(8)), network.now)
    answers = server.datagrams_to_send()
    assert {len(answer) for answer in answers} == {messages.HELLO_SIZE}
    assert server._pending == []
    exchange(network)


def test_cookies_are_bound_to_the_address_and_expire():
    network = connected()
    initiate = next(data for _, data in network.recorded if data[0] == messages.INITIATE)
    answering = network.ends[1]._responder
    answering.initiate(initiate, b"other", network.now)
    assert answering.refusals == {"wrong cookie": 1}
    answering.initiate(initiate, b"client", network.now)  # a duplicate: answered again
    assert answering.refusals == {"wrong cookie": 1}
    answering.initiate(initiate, b"client", network.now + 200)
    assert answering.refusals == {"wrong cookie": 2}


def test_a_host_that_floods_with_handshakes_does_not_lock_out_the_others():
    network = connected()
    answering = network.ends[1]._responder
    for number in range(300):
        nonce, address = number.to_bytes(8), b"10.0.0.9:%d" % number
        cookie = answering.hello(messages.hello(SHARED.suite, nonce), address, network.now).data[9:]
        header = messages.initiate_header(SHARED.suite, 0, messages.Challenge(nonce, cookie))
        answering.initiate(header + bytes(48), address, network.now)
    assert answering.refusals["forged or unknown key"] == responder.HOST_BURST
    assert answering.refusals["too many handshakes"] == 300 - responder.HOST_BURST
    network.ends[0] = network.client()  # restarted meanwhile
    network.run(1.0)
    exchange(network)


def test_the_hosts_whose_handshakes_are_counted_are_bounded():
    answering = connected().ends[1]._responder
    for number in range(2000):
        answering._allowance_of(b"10.0.%d.%d:1" % divmod(number, 256))
    assert len(answering._hosts) == 1024


@given(st.binary(max_size=200), st.integers(0, 1))
def test_hostile_bytes_are_counted_and_change_nothing(data, receiver):
    network = NETWORK
    network.inject(receiver, data)
    for kind in (1, 2, 3, 4, 5, 0x80, 0xD0):
        network.inject(receiver, bytes((kind,)) + data)
    network.run(0.01, 0.01)
    assert network.received[receiver] == []
    assert network.ends[receiver].is_open


NETWORK = connected()


def test_notices_of_unknown_sessions_are_believed_once_a_second():
    network = connected()
    frame = network.ends[0].seal(b"x", network.now)
    notice = bytes((messages.UNKNOWN,)) + frame[:4]
    network.run(2.0)
    for _ in range(100):
        network.ends[0].receive(notice, network.now)
    assert len(network.ends[0].datagrams_to_send()) == 1
    network.ends[0].receive(bytes((messages.UNKNOWN,)) + bytes(4), network.now)
    assert network.ends[0].refusals["malformed"] == 1
