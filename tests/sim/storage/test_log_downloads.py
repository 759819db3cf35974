"""Onboard logs over a simulated network: listing, download and erasing, also while a log is written."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

import pytest

from mavstack.errors import LogTimeout, RemoteDenied
from mavstack.services.ftp import FtpClient, FtpServer, MemoryStore
from mavstack.services.log import LogClient, LogEntry, LogServer
from mavstack.sim.storage import DataflashLogs, UlogLogs
from tests.services.network import GROUND, VEHICLE, Network, random_impairment
from tests.sim.storage.samples import SECOND, content, fly, log_start, paths, sample

if TYPE_CHECKING:
    from tests.seeds import Seeds


class LogNetwork:
    """A vehicle that serves logs and files, and a client, over a simulated network."""

    def __init__(self, seed: int, logs, store, impairment=None) -> None:
        self.network = Network(seed)
        self.vehicle = self.network.node(VEHICLE)
        self.vehicle.engine.add(LogServer(VEHICLE, logs))
        self.vehicle.engine.add(FtpServer(VEHICLE, store))
        self.ground = self.network.node(GROUND)
        self.logs = self.ground.engine.add(LogClient(GROUND, VEHICLE))
        self.files = self.ground.engine.add(FtpClient(GROUND, VEHICLE))
        self.network.connect(self.ground, self.vehicle, impairment)

    @property
    def now(self) -> float:
        return self.network.now

    def run(self, client, operation):
        self.ground.engine.touch(client)
        assert self.network.run(lambda: operation.done, timeout=2000)
        return operation


@pytest.mark.parametrize("log_class", [DataflashLogs, UlogLogs], ids=["ardupilot", "px4"])
def test_over_the_network(log_class) -> None:
    store = MemoryStore()
    logs = log_class(store, log_start)
    fly(logs, 0, samples=40)
    fly(logs, 10 * SECOND, samples=3)
    network = LogNetwork(1, logs, store)
    listed = network.run(network.logs, network.logs.list_logs(network.now)).result()
    assert list(listed) == list(logs.logs())
    for entry in listed:
        data = network.run(network.logs, network.logs.download(entry, network.now)).result()
        assert data == content(logs, entry.id)
    for path in paths(store):
        data = network.run(network.files, network.files.download(path, network.now)).result()
        assert data == store[path]
    network.run(network.logs, network.logs.erase(network.now)).result()
    assert logs.logs() == []


def scenario(seed: int) -> None:
    """Download a log while it is written, over a random network: a part, the whole, or a typed error."""
    random = Random(seed)
    store = MemoryStore()
    logs = random.choice([DataflashLogs, UlogLogs])(store, log_start)
    fly(logs, 0, samples=random.randrange(9))
    logs.begin(10 * SECOND)
    network = LogNetwork(seed, logs, store, random_impairment(random))

    def write_sample(step: int) -> None:
        logs.write(sample(10 * SECOND + step * 100_000))

    for step in range(20):
        network.network.at(step / 10, lambda step=step: write_sample(step))
    entry: LogEntry = random.choice(logs.logs())
    operation = network.run(network.logs, network.logs.download(entry, network.now, timeout=900.0))
    if operation.error is None:
        data = operation.result()
        assert len(data) >= entry.size
        assert content(logs, entry.id).startswith(data)
    else:
        assert isinstance(operation.error, LogTimeout | RemoteDenied)


def test_download_while_writing(seeds: Seeds) -> None:
    seeds.check(scenario)
