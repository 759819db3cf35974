"""S6: clients that try to stop an FTP server, to fill its memory or disk, or to leave its root."""

from __future__ import annotations

import os
from threading import Event, Thread
from time import perf_counter, process_time

import pytest

from mavstack.services import Address
from mavstack.services.ftp import (
    DirectoryStore,
    FtpError,
    FtpPayload,
    FtpServer,
    MemoryStore,
    Opcode,
    OverlayStore,
    VirtualFile,
)
from mavstack.services.ftp.overlay import MAX_UPLOADS
from mavstack.services.ftp.sessions import MAX_SESSIONS, MAX_SESSIONS_PER_CLIENT, MIN_SESSION_DURATION
from mavstack.sim.storage.roots import FOLDER_CAPACITY, file_store
from tests.services.ftp.test_pitfalls import ask
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, sent_by

HUGE = (1 << 32) - 1


def client(number: int) -> Address:
    return Address(number % 250 + 2, number // 250 + 1)


def request(server, opcode, data=b"", *, source=GROUND, now=START, sequence=1, **fields) -> None:
    payload = FtpPayload.request(opcode, data, **fields).numbered(sequence)
    deliver(server, payload.to_message(*VEHICLE), source, now)


def replies(server, now) -> list[tuple[int, FtpPayload]]:
    return [(message.target_system, FtpPayload.read(message)) for message in sent_by(server, now)]


@pytest.fixture
def serve():
    servers = []

    def make(store) -> FtpServer:
        servers.append(FtpServer(VEHICLE, store))
        return servers[-1]

    yield make
    for server in servers:
        for session in server.sessions:
            server.sessions.drop(session)


# Time


def test_a_checksum_of_a_huge_file_does_not_stop_the_process(serve, tmp_path) -> None:
    """Before: 11 s in one call. Others are answered meanwhile."""
    with (tmp_path / "huge").open("wb") as file:
        file.truncate(1 << 28)
    (tmp_path / "small").write_bytes(b"x")
    server = serve(DirectoryStore(tmp_path))
    durations, answered, now = [], [], START
    for turn in range(40):
        started = process_time()
        request(server, Opcode.CALCFILECRC, b"huge", now=now)  # the attacker repeats it
        if turn == 5:
            request(server, Opcode.CALCFILECRC, b"small", source=client(9), now=now)
        server.handle_timeout(now)
        answered += [(system, turn) for system, _ in replies(server, now)]
        durations.append(process_time() - started)
        now += 0.01
    assert max(durations) < 0.2
    assert [system for system, _ in answered] == [client(9).system]
    assert answered[0][1] <= 6
    while not (last := replies(server, now)):
        now += 0.01
        server.handle_timeout(now)
    assert last[0][1].error is None


def test_a_flood_of_listings_is_executed_slowly_and_in_turns(serve, tmp_path) -> None:
    for number in range(1000):
        (tmp_path / f"{number:04}").write_bytes(b"")
    server = serve(DirectoryStore(tmp_path))
    listed = 0
    list_directory = server.store.list_directory

    def counted(path):
        nonlocal listed
        listed += 1
        return list_directory(path)

    server.store.list_directory = counted
    for number in range(500):
        request(server, Opcode.LISTDIRECTORY, b"/", sequence=number)
    request(server, Opcode.LISTDIRECTORY, b"/", source=client(9))
    assert listed < 20
    server.handle_timeout(START + 0.05)
    assert client(9).system in [system for system, _ in replies(server, START + 0.05)]


@pytest.mark.parametrize("opcode", [Opcode.CREATEDIRECTORY, Opcode.REMOVEFILE, Opcode.RENAME])
def test_a_flood_of_changes_is_executed_slowly_and_in_turns(serve, tmp_path, opcode) -> None:
    """Before: vehicles stopped for 5 s after 3,000 requests."""
    server = serve(OverlayStore(DirectoryStore(tmp_path)))
    for number in range(500):
        request(server, opcode, b"d%d\0e%d" % (number, number), sequence=number)
    assert len(replies(server, START)) < 20
    request(server, opcode, b"mine\0other", source=client(9))
    server.handle_timeout(START + 0.05)
    assert client(9).system in [system for system, _ in replies(server, START + 0.05)]


def test_a_change_of_a_directory_does_not_list_it(serve, tmp_path) -> None:
    base = DirectoryStore(tmp_path)
    (tmp_path / "logs").mkdir()
    store = OverlayStore(base, {"logs/virtual": VirtualFile(lambda query: b"")})
    base.list_directory = lambda path: pytest.fail("a listing takes long")
    for path in ("new", "logs/new"):
        store.make_directory(path)
        assert (tmp_path / path).is_dir()


def test_the_pages_of_a_listing_need_one_scan(serve, tmp_path) -> None:
    for number in range(300):
        (tmp_path / f"{number:04}").write_bytes(b"")
    server = serve(DirectoryStore(tmp_path))
    scans = []
    list_directory = server.store.list_directory
    server.store.list_directory = lambda path: scans.append(path) or list_directory(path)
    index = sequence = 0
    while True:
        now = START + sequence * 0.01
        (page,) = ask(server, Opcode.LISTDIRECTORY, b"/", offset=index, sequence=sequence, now=now)
        if page.error is not None:
            break
        index, sequence = index + page.data.count(b"\0"), sequence + 1
    assert (index, page.error, len(scans)) == (300, FtpError.EOF, 1)


# Memory and disk


def test_uploads_to_virtual_files_are_bounded(serve) -> None:
    """Before: 16 writes at offset 64 MiB took 1 GB."""
    stored = []
    names = [f"@PARAM/{number}" for number in range(16)]
    store = OverlayStore(
        MemoryStore(), {name: VirtualFile(lambda query: b"", stored.append) for name in names}
    )
    server = serve(store)
    accepted = 0
    for number, name in enumerate(names):
        source = client(number)
        (opened,) = ask(server, Opcode.CREATEFILE, name.encode(), source=source, now=START + number)
        assert opened.error is None
        for sequence, offset in ((2, 64 << 20), (3, 1_000_000)):
            (reply,) = ask(
                server,
                Opcode.WRITEFILE,
                b"x",
                source=source,
                sequence=sequence,
                offset=offset,
                now=START + number,
            )
            accepted += reply.error is None
        assert reply.error is None or number >= 4
    assert accepted * 1_000_000 <= MAX_UPLOADS


def test_a_folder_has_a_quota(serve, tmp_path) -> None:
    store = file_store(tmp_path / "card")
    server = serve(store)
    ask(server, Opcode.CREATEFILE, b"f")
    errors = [
        ask(server, Opcode.WRITEFILE, b"x", offset=HUGE - 1, sequence=2)[0].errno,
        ask(server, Opcode.TRUNCATEFILE, b"f", offset=HUGE, sequence=3)[0].errno,
        ask(server, Opcode.WRITEFILE, b"x", offset=FOLDER_CAPACITY, sequence=4)[0].errno,
        ask(server, Opcode.WRITEFILE, b"x", offset=FOLDER_CAPACITY - 1, sequence=5)[0].errno,
        ask(server, Opcode.CREATEFILE, b"g", session=1, sequence=6)[0].errno,
        ask(server, Opcode.WRITEFILE, b"x", session=1, sequence=7)[0].errno,
        ask(server, Opcode.TRUNCATEFILE, b"f", sequence=8)[0].errno,
        ask(server, Opcode.WRITEFILE, b"x", session=1, sequence=9)[0].errno,
    ]
    assert errors == [28, 28, 28, None, None, 28, None, None]


def test_the_number_of_files_is_bounded(serve, tmp_path) -> None:
    store = DirectoryStore(tmp_path, max_entries=50)
    server = serve(store)
    for number in range(100):
        ask(server, Opcode.CREATEDIRECTORY, b"d%d" % number, sequence=number, now=START + number * 0.01)
    assert len(list(tmp_path.iterdir())) == 50


@pytest.mark.parametrize("kind", ["memory", "disk"])
def test_a_removed_file_that_is_open_counts(serve, tmp_path, kind: str) -> None:
    """Sixteen open, removed files must not hold sixteen times the capacity."""
    limit = 1 << 20
    store = MemoryStore(capacity=limit) if kind == "memory" else DirectoryStore(tmp_path, capacity=limit)
    server = serve(store)
    held = 0
    for number in range(16):
        source, now = client(number), START + number
        ask(server, Opcode.CREATEFILE, b"f", source=source, now=now)
        ask(server, Opcode.WRITEFILE, b"x", offset=limit - 1, source=source, sequence=2, now=now)
        ask(server, Opcode.REMOVEFILE, b"f", source=source, sequence=3, now=now)
        ask(server, Opcode.WRITEFILE, b"x", offset=limit // 2, source=source, sequence=4, now=now)
    held = sum(session.file.size() for session in server.sessions)
    assert held <= limit


# Sessions


def test_one_client_does_not_take_all_sessions(serve) -> None:
    server = serve(MemoryStore({"f": b"x"}))
    codes = [
        ask(server, Opcode.OPENFILERO, b"f", session=number, sequence=number, now=START + number / 100)[
            0
        ].error
        for number in range(MAX_SESSIONS_PER_CLIENT + 1)
    ]
    assert codes == [None] * MAX_SESSIONS_PER_CLIENT + [FtpError.NOSESSIONSAVAILABLE]


def test_many_busy_clients_leave_others_a_session(serve) -> None:
    """Before: 16 sessions that were used every second locked everybody else out for ever."""
    server = serve(MemoryStore({"f": b"x"}))
    opened_after = None
    for second in range(60):
        now = START + second
        for number in range(MAX_SESSIONS):
            source = client(number)
            if not second:
                ask(server, Opcode.OPENFILERO, b"f", source=source, now=now + number / 100)
            ask(server, Opcode.READFILE, size=1, source=source, sequence=second + 2, now=now + 0.7)
        other_client = client(240)
        (reply,) = ask(server, Opcode.OPENFILERO, b"f", source=other_client, sequence=second, now=now + 0.9)
        if reply.error is None:
            opened_after = second
            break
    assert opened_after is not None
    assert opened_after <= MIN_SESSION_DURATION


def test_a_signed_client_has_a_session_at_once_and_keeps_it() -> None:
    pilot, now = GROUND, START
    server = FtpServer(VEHICLE, MemoryStore({"f": b"x"}), is_authenticated=lambda source: source == pilot)
    for number in range(MAX_SESSIONS):
        ask(server, Opcode.OPENFILERO, b"f", source=client(number), now=now + number / 100)
    (opened,) = ask(server, Opcode.OPENFILERO, b"f", source=pilot, now=now + 1)
    assert opened.error is None
    for turn in range(100):
        now += 1
        stranger = client(turn % 300)
        for number in range(MAX_SESSIONS):
            ask(server, Opcode.READFILE, size=1, source=client(number), sequence=turn, now=now)
        ask(server, Opcode.OPENFILERO, b"f", source=stranger, sequence=500 + turn, session=1, now=now)
        (read,) = ask(server, Opcode.READFILE, size=1, source=pilot, sequence=2 + turn, now=now)
        assert read.data == b"x"


def test_bursts_share_a_slow_link(serve) -> None:
    """Before: the first session got all the room of the link."""
    server = serve(MemoryStore({"f": bytes(30_000)}))
    clients = [client(number) for number in range(16)]
    for number, source in enumerate(clients):
        ask(server, Opcode.OPENFILERO, b"f", source=source, now=START + number / 100)
    for source in clients:
        request(server, Opcode.BURSTREADFILE, source=source, sequence=2, size=239, now=START + 0.5)
    packets = dict.fromkeys((source.system for source in clients), 0)
    for step in range(160):
        room = iter([True])
        for message in sent_by(server, START + 0.5 + step / 1000, lambda *_: next(room, False)):  # noqa: B023
            packets[message.target_system] += 1
    assert set(packets.values()) == {10}


# Leaving the root


@pytest.mark.skipif(os.open not in os.supports_dir_fd, reason="no handles of directories here")
def test_a_directory_exchanged_for_a_link_leads_nowhere(tmp_path) -> None:
    """Before: 220 of 431 opens read the file outside."""
    root, outside = tmp_path / "root", tmp_path / "outside"
    for place, content in ((root / "d", b"inside"), (outside, b"secret")):
        place.mkdir(parents=True)
        (place / "f").write_bytes(content)
    (root / "link").symlink_to(outside)
    store, stop = DirectoryStore(root), Event()

    def exchange() -> None:
        while not stop.is_set():
            (root / "d").rename(root / "kept")
            (root / "link").rename(root / "d")
            (root / "d").rename(root / "link")
            (root / "kept").rename(root / "d")

    thread = Thread(target=exchange)
    thread.start()
    try:
        contents = set()
        started = perf_counter()
        while perf_counter() - started < 1.0:
            try:
                file = store.open_file("d/f")
            except OSError:
                continue
            contents.add(file.read(0, 99))
            file.close()
            try:
                store.truncate("d/f", 6)
                store.list_directory("d")
            except OSError:
                continue
    finally:
        stop.set()
        thread.join()
    assert contents == {b"inside"}
    assert (outside / "f").read_bytes() == b"secret"
