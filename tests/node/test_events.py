"""The events of a remote component: streams, listeners, and the metadata that they wait for."""

from __future__ import annotations

import asyncio
import lzma

import pytest

from mavstack.dialects import common
from mavstack.errors import FileDenied, InvalidArgumentError, InvalidTypeError, RemoteDenied
from mavstack.files.parameter_metadata import MetadataCache
from mavstack.node.events import METADATA_TIMEOUT, RETRY_INTERVAL
from mavstack.services.component_metadata import ServedMetadata
from mavstack.services.events import EventSender, LogLevel
from mavstack.sim.virtual import run_virtually
from tests.node.test_metadata_files import serve, serve_file
from tests.node.vehicle import VehiclePair
from tests.services.events.test_definitions import document
from tests.waiting import wait_until

STOPPED, UNKNOWN = 0x01000005, 0x01000006
MESSAGE = "Stopped: too hot at 0.0 m"


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> MetadataCache:
    """Keep the files of each test in a folder of its own."""
    cache = MetadataCache(tmp_path / "cache")
    monkeypatch.setattr("mavstack.node.events.USER_CACHE", cache)
    return cache


class EventPair(VehiclePair):
    """A ground station, and a vehicle with events."""

    async def __aenter__(self):
        await super().__aenter__()
        self.sender = self.vehicle.serve(EventSender(self.vehicle.address, self.vehicle.now()))
        return self

    def serve_metadata(self) -> list[str]:
        served = ServedMetadata(
            "etc/extras", {common.CompMetadataType.EVENTS: ("all_events.json", document())}
        )
        return serve(self, served.files, served.uri, served.crc)

    def report(self, event_id: int = STOPPED, level: LogLevel = LogLevel.INFO) -> None:
        self.sender.report(event_id, self.vehicle.now(), arguments=b"\x01", level=level)
        self.vehicle.wake(self.sender)


def with_pair(work) -> None:
    async def run() -> None:
        async with EventPair() as pair:
            await work(pair, pair.remote)

    run_virtually(run())


def test_events_are_delivered_with_their_words():
    async def work(pair: EventPair, remote) -> None:
        opened = pair.serve_metadata()
        async with remote.events() as events:
            pair.report()
            pair.report(UNKNOWN)
            first, second = await anext(events), await anext(events)
            assert (first.name, first.message) == ("sample::stopped", MESSAGE)
            assert (first.severity, first.arguments["cause"]) == (LogLevel.INFO, "hot")
            assert first.source == remote.address
            assert (second.is_known, second.message) == (False, "event 0x01000006 (no metadata)")
            files = len(opened)
            pair.report()
            assert (await anext(events)).is_known
            assert (len(opened), events.lost, events.dropped) == (files, 0, 0)
        with pytest.raises(StopAsyncIteration):
            await anext(events)

    with_pair(work)


def test_severity_selects_and_events_for_programs_are_left_out():
    async def work(pair: EventPair, remote) -> None:
        pair.serve_metadata()
        async with (
            remote.events(severity=LogLevel.WARNING) as warnings,
            remote.events() as shown,
            remote.events(severity=LogLevel.DISABLED) as everything,
        ):
            for level in (LogLevel.PROTOCOL, LogLevel.INFO, LogLevel.ERROR):
                pair.report(level=level)
            assert (await anext(warnings)).severity == LogLevel.ERROR
            assert [(await anext(shown)).severity for _ in range(2)] == [LogLevel.INFO, LogLevel.ERROR]
            assert (await anext(everything)).severity == LogLevel.PROTOCOL

    with_pair(work)


@pytest.mark.parametrize(("severity", "error"), [(-1, InvalidArgumentError), ("INFO", InvalidTypeError)])
def test_invalid_severities_are_refused(severity, error):
    async def work(pair: EventPair, remote) -> None:
        with pytest.raises(error, match="severity must be"):
            remote.events(severity=severity)

    with_pair(work)


def test_a_listener_is_called_until_it_is_closed():
    async def work(pair: EventPair, remote) -> None:
        pair.serve_metadata()
        messages, failures = [], []
        asyncio.get_running_loop().set_exception_handler(lambda loop, context: failures.append(context))

        def receive(event) -> None:
            messages.append(event.message)
            if not event.is_known:
                raise RuntimeError("a defect of the program")

        listener = remote.add_event_listener(receive)
        pair.report(UNKNOWN)
        pair.report()
        await wait_until(lambda: MESSAGE in messages, now=pair.ground.now)
        assert len(failures) == 1
        listener.close()
        pair.report()
        await asyncio.sleep(1)
        assert (len(messages), listener.lost) == (2, 0)

    with_pair(work)


def test_missing_and_lost_events():
    async def work(pair: EventPair, remote) -> None:
        pair.serve_metadata()
        async with remote.events() as events:
            pair.report()
            assert (await anext(events)).sequence == 65526
            for _ in range(5):  # not sent, as if the link had lost them
                pair.sender.report(STOPPED, pair.vehicle.now())
            pair.sender._outbox.clear()
            for gone in (65527, 65528):
                del pair.sender._kept[gone]
            pair.report()
            assert [(await anext(events)).sequence for _ in range(4)] == [65529, 65530, 65531, 65532]
            assert events.lost == 2

    with_pair(work)


def test_a_cancelled_wait_for_the_metadata_loses_no_event():
    async def work(pair: EventPair, remote) -> None:
        pair.serve_metadata()
        async with remote.events() as events:
            pair.report()
            waiting = asyncio.ensure_future(anext(events))
            await wait_until(lambda: remote._event_metadata._loading is not None, interval=0.0)
            waiting.cancel()
            assert (await anext(events)).message == MESSAGE

    with_pair(work)


def test_events_of_a_component_without_metadata_have_no_words():
    async def work(pair: EventPair, remote) -> None:
        async with remote.events() as events:
            pair.report()
            assert (await anext(events)).message == "event 0x01000005 (no metadata)"
            with pytest.raises(RemoteDenied, match="it has none"):
                await remote.download_event_metadata(cache=None)
            pair.serve_metadata()
            pair.report()
            assert not (await anext(events)).is_known, "a refusal is final until the reboot"
            remote.clear_cache()
            pair.report()
            assert (await anext(events)).message == MESSAGE

    with_pair(work)


def test_a_component_that_does_not_answer_is_asked_again_later():
    async def work(pair: EventPair, remote) -> None:
        pair.serve_metadata()
        pair.vehicle._host.remove(pair.vehicle.ftp)
        async with remote.events() as events:
            pair.report()
            assert not (await anext(events)).is_known
            pair.vehicle.serve(pair.vehicle.ftp)
            pair.report()
            assert not (await anext(events)).is_known
            await asyncio.sleep(RETRY_INTERVAL + METADATA_TIMEOUT)
            pair.report()
            assert (await anext(events)).is_known

    with_pair(work)


def test_metadata_from_the_web_and_from_the_cache(cache):
    async def work(pair: EventPair, remote) -> None:
        entry = {"type": common.CompMetadataType.EVENTS, "uri": "https://example.org/events.json.xz"}
        serve_file(pair, entry)
        with pytest.raises(RemoteDenied, match="a fetch function is needed"):
            await remote.download_event_metadata(cache=None)
        table = await remote.download_event_metadata(fetch=lambda url: lzma.compress(document()), cache=None)
        assert table[STOPPED].name == "sample::stopped"
        async with remote.events() as events:
            pair.report()
            assert (await anext(events)).is_known

    async def again(pair: EventPair, remote) -> None:
        opened = pair.serve_metadata()
        await remote.download_event_metadata(cache=cache)
        files = len(opened)
        await remote.download_event_metadata(cache=cache)
        assert len(opened) == files

    with_pair(work)
    with_pair(again)


def test_a_damaged_file_is_reported_with_its_place():
    async def work(pair: EventPair, remote) -> None:
        serve_file(pair, {"type": common.CompMetadataType.EVENTS, "uri": "mftp:///none.json"})
        with pytest.raises(FileDenied, match=r"none\.json"):
            await remote.download_event_metadata(cache=None)

    with_pair(work)
