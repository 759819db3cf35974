"""Logs over random networks: the whole log, or a typed error within its deadline."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.errors import LogTimeout, RemoteDenied, RemoteError, RemoteProtocolError
from mavstack.services import Address
from mavstack.services.log import LogClient, LogServer
from tests.services.log.store import random_store
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds

DEADLINE = 1800.0
OTHER = Address(254, 190)


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    store = random_store(random)
    contents = dict(store.contents)
    vehicle = network.node(VEHICLE, lambda engine: engine.add(LogServer(VEHICLE, store)))
    grounds = [network.node(address) for address in (GROUND, OTHER)[: random.choice([1, 1, 2])]]
    clients = [ground.engine.add(LogClient(ground.address, VEHICLE)) for ground in grounds]
    for ground in grounds:
        bandwidth = random.choice([None, None, 5760.0])
        with_cuts(network, network.connect(ground, vehicle, random_impairment(random), bandwidth=bandwidth))
    if random.random() < 0.2:
        network.at(random.uniform(0, 3), vehicle.restart)
    if random.random() < 0.2:
        forgotten = clients[0].download(1, network.now)
        grounds[0].engine.touch(clients[0])
        network.run(lambda: forgotten.done, timeout=random.uniform(0, 1))
        grounds[0].restart()
        clients[0] = grounds[0].engine.add(LogClient(grounds[0].address, VEHICLE))
    listings = [client.list_logs(network.now, timeout=DEADLINE / 4) for client in clients]
    wanted = random.choice(sorted(contents)) if contents else 3
    downloads = [client.download(wanted, network.now, timeout=DEADLINE / 2) for client in clients]
    for client, ground in zip(clients, grounds, strict=True):
        ground.engine.touch(client)
    operations = [*listings, *downloads]
    assert network.run(lambda: all(operation.done for operation in operations), timeout=DEADLINE)
    for listing in listings:
        if listing.error is None:
            assert list(listing.result()) == store.logs()
        else:
            assert isinstance(listing.error, LogTimeout)
    for download in downloads:
        if download.error is None:
            assert download.result() == contents[wanted]
        else:
            assert isinstance(download.error, LogTimeout | RemoteDenied)
            assert isinstance(download.error, LogTimeout) or not contents


def test_logs_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)


def replaced(seed: int) -> None:
    """The log is erased, and its id used again, while it is read."""
    network, random = Network(seed), Random(seed)
    store = random_store(random, first=1)
    store.contents[1] = old = random.randbytes(random.randrange(1, 30_000))
    vehicle = network.node(VEHICLE, lambda engine: engine.add(LogServer(VEHICLE, store)))
    ground = network.node(GROUND)
    client = ground.engine.add(LogClient(GROUND, VEHICLE))
    network.connect(ground, vehicle, random_impairment(random))
    new = random.randbytes(random.choice([len(old), random.randrange(30_000)]))

    def replace() -> None:
        store.erase()
        store.contents[1], store.times[1] = new, 1_700_000_000

    network.at(random.uniform(0, 3), replace)
    download = client.download(1, network.now, timeout=DEADLINE / 2)
    ground.engine.touch(client)
    assert network.run(lambda: download.done, timeout=DEADLINE)
    if download.error is None:
        # A larger log under the same id may be the same one, written on: then its beginning is enough.
        result = download.result()
        assert result in (old, new) or (len(result) >= len(old) and new.startswith(result))
    else:
        assert isinstance(download.error, LogTimeout | RemoteProtocolError)


def test_a_log_replaced_while_it_is_read_is_never_mixed(seeds: Seeds) -> None:
    seeds.check(replaced)


def erased(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    store = random_store(random)
    had = bool(store.contents)
    vehicle = network.node(VEHICLE, lambda engine: engine.add(LogServer(VEHICLE, store)))
    ground = network.node(GROUND)
    client = ground.engine.add(LogClient(GROUND, VEHICLE))
    with_cuts(network, network.connect(ground, vehicle, random_impairment(random)))
    erasing = client.erase(network.now, timeout=DEADLINE / 2)
    ground.engine.touch(client)
    assert network.run(lambda: erasing.done, timeout=DEADLINE)
    if erasing.error is None:
        assert not store.contents
    else:
        assert isinstance(erasing.error, RemoteError)
        assert had or isinstance(erasing.error, LogTimeout)


def test_erasing_over_bad_links(seeds: Seeds) -> None:
    seeds.check(erased)
