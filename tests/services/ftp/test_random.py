"""Files over random networks: the exact file, or a typed error within the deadline."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.errors import FileDenied, FileTimeout, RemoteCancelled, RemoteProtocolError
from mavstack.services.ftp import FtpError, MemoryStore
from tests.services.ftp.ends import Ends
from tests.services.network import Air, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds

DEADLINE = 600.0
TIMEOUT = 120.0


def reading(seed: int) -> None:
    random = Random(seed)
    data = random.randbytes(random.choice([0, 1, 239, 240, 3000, random.randrange(60_000)]))
    ends = Ends(seed, MemoryStore({"f": data}), random_impairment(random), paced=random.random() < 0.5)
    with_cuts(ends.network, ends.pipes)
    if random.random() < 0.2:
        ends.network.at(random.uniform(0, 3), ends.vehicle.restart)
    operation = ends.client.download("f", ends.now, timeout=TIMEOUT)
    if random.random() < 0.2:
        ends.network.at(random.uniform(0, 3), lambda: cancel(ends, operation))
    ends.run(operation, timeout=DEADLINE)
    if operation.error is None:
        assert operation.result() == data
    else:
        assert isinstance(operation.error, FileTimeout | FileDenied | RemoteCancelled)
        if isinstance(operation.error, FileDenied):
            assert operation.error.code == FtpError.INVALIDSESSION
    all_sessions_end(ends)


def cancel(ends: Ends, operation) -> None:
    ends.client.cancel(operation, ends.now)
    ends.ground.engine.touch(ends.client)


def all_sessions_end(ends: Ends) -> None:
    ends.settle()
    ends.network.run(timeout=30.0)
    assert len(ends.server.sessions) == 0


def writing(seed: int) -> None:
    random = Random(seed)
    data = random.randbytes(random.choice([0, 1, 239, 5000, random.randrange(30_000)]))
    store = MemoryStore({"f": b"what was there before"})
    ends = Ends(seed, store, random_impairment(random))
    with_cuts(ends.network, ends.pipes)
    if random.random() < 0.2:
        ends.network.at(random.uniform(0, 3), ends.vehicle.restart)
    operation = ends.client.upload("f", data, ends.now, timeout=TIMEOUT)
    ends.run(operation, timeout=DEADLINE)
    if operation.error is None:
        assert store["f"] == data
    else:
        assert isinstance(operation.error, FileTimeout | FileDenied)
    all_sessions_end(ends)


def changing(seed: int) -> None:
    """Each change is carried out once, however often it was asked for."""
    random = Random(seed)
    store = MemoryStore({"a": b"1234", "gone": b""})
    ends = Ends(seed, store, random_impairment(random))
    with_cuts(ends.network, ends.pipes)
    client, now = ends.client, ends.now
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
        ends.run(operation, timeout=DEADLINE)
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
    ends = Ends(seed, store, random_impairment(random, worst_loss=0.2), air=Air() if seed % 2 else None)

    def change() -> None:
        store._files["f",][:] = new

    ends.network.at(random.uniform(0, 2), change)
    operation = ends.client.download("f", ends.now, timeout=TIMEOUT)
    ends.run(operation, timeout=DEADLINE)
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
