"""Files over random networks: the exact file, or a typed error within the deadline."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.errors import FileDenied, FileTimeout, RemoteCancelled, RemoteProtocolError
from mavstack.services.ftp import FtpError, MemoryStore
from tests.services.ftp.harness import FtpHarness
from tests.services.network import HalfDuplexRadio, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds

DEADLINE = 600.0
TIMEOUT = 120.0


def reading(seed: int) -> None:
    random = Random(seed)
    data = random.randbytes(random.choice([0, 1, 239, 240, 3000, random.randrange(60_000)]))
    harness = FtpHarness(
        seed, MemoryStore({"f": data}), random_impairment(random), paced=random.random() < 0.5
    )
    with_cuts(harness.network, harness.pipes)
    if random.random() < 0.2:
        harness.network.at(random.uniform(0, 3), harness.vehicle.restart)
    operation = harness.client.download("f", harness.now, timeout=TIMEOUT)
    if random.random() < 0.2:
        harness.network.at(random.uniform(0, 3), lambda: cancel(harness, operation))
    harness.run(operation, timeout=DEADLINE)
    if operation.error is None:
        assert operation.result() == data
    else:
        assert isinstance(operation.error, FileTimeout | FileDenied | RemoteCancelled)
        if isinstance(operation.error, FileDenied):
            assert operation.error.code == FtpError.INVALIDSESSION
    all_sessions_end(harness)


def cancel(harness: FtpHarness, operation) -> None:
    harness.client.cancel(operation, harness.now)
    harness.ground.engine.touch(harness.client)


def all_sessions_end(harness: FtpHarness) -> None:
    harness.settle()
    harness.network.run(timeout=30.0)
    assert len(harness.server.sessions) == 0


def writing(seed: int) -> None:
    random = Random(seed)
    data = random.randbytes(random.choice([0, 1, 239, 5000, random.randrange(30_000)]))
    store = MemoryStore({"f": b"what was there before"})
    harness = FtpHarness(seed, store, random_impairment(random))
    with_cuts(harness.network, harness.pipes)
    if random.random() < 0.2:
        harness.network.at(random.uniform(0, 3), harness.vehicle.restart)
    operation = harness.client.upload("f", data, harness.now, timeout=TIMEOUT)
    harness.run(operation, timeout=DEADLINE)
    if operation.error is None:
        assert store["f"] == data
    else:
        assert isinstance(operation.error, FileTimeout | FileDenied)
    all_sessions_end(harness)


def changing(seed: int) -> None:
    """Each change is carried out once, however often it was asked for."""
    random = Random(seed)
    store = MemoryStore({"a": b"1234", "gone": b""})
    harness = FtpHarness(seed, store, random_impairment(random))
    with_cuts(harness.network, harness.pipes)
    client, now = harness.client, harness.now
    operations = [
        client.rename("a", "b", now),
        client.truncate("b", 2, now),
        client.make_directory("d", now),
        client.rename("b", "d/c", now),
        client.remove("gone", now),
        client.checksum("d/c", now),
        client.list_directory("/", now),
    ]
    for operation in operations:
        harness.run(operation, timeout=DEADLINE)
    if all(operation.error is None for operation in operations):
        assert store["d/c"] == b"12"
        assert "gone" not in store
        assert [entry.name for entry in operations[-1].result()] == ["d"]
    else:
        first = next(operation.error for operation in operations if operation.error)
        assert isinstance(first, FileTimeout)


def shrinking(seed: int) -> None:
    """A file that changes during the download is reported, never returned as a mix."""
    random = Random(seed)
    old, new = random.randbytes(random.randrange(1000, 20_000)), random.randbytes(random.randrange(20_000))
    store = MemoryStore({"f": old})
    harness = FtpHarness(
        seed, store, random_impairment(random, worst_loss=0.2), radio=HalfDuplexRadio() if seed % 2 else None
    )

    def change() -> None:
        store._files["f",][:] = new

    harness.network.at(random.uniform(0, 2), change)
    operation = harness.client.download("f", harness.now, timeout=TIMEOUT)
    harness.run(operation, timeout=DEADLINE)
    if operation.error is None and operation.verified:
        assert operation.result() in (old, new)
    elif operation.error is not None:
        assert isinstance(operation.error, FileTimeout | RemoteProtocolError)


def test_reading_over_bad_links(seeds: Seeds) -> None:
    seeds.check(reading)


def test_writing_over_bad_links(seeds: Seeds) -> None:
    seeds.check(writing)


def test_changes_over_bad_links(seeds: Seeds) -> None:
    seeds.check(changing)


def test_files_that_change_over_bad_links(seeds: Seeds) -> None:
    seeds.check(shrinking)
