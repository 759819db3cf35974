"""A grant begins after the packets that were taken before it; what the core knows is noted when it ends."""

from __future__ import annotations

import os
from types import SimpleNamespace

import pytest

import mavstack
from mavstack.dialects import common
from mavstack.node.native_runs import Taken
from mavstack.services.heartbeat import ComponentRebooted
from tests.node.test_native_input import DIALECT, arrivals, flush, granted, native, vehicle_on

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the event loop waits for no descriptor")


@pytest.mark.parametrize("all_sources", [False, True])
async def test_packets_that_were_granted_before_a_change_are_checked_after_it(monkeypatch, all_sources):
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        runs, deliver = [], native(node)._deliver
        monkeypatch.setattr(native(node), "_deliver", lambda run: (runs.append(run), deliver(run)))
        with_listener = node.add_listener(common.VfrHud, lambda message: None)
        await flush(node, sender)
        runs.clear()
        native(node)._revoke_all() if all_sources else native(node)._revoke((1, 1))
        sender.send(common.VfrHud())
        await flush(node, sender)
        assert not runs[0].is_checked
        await granted(node, sender)
        for _ in range(3):
            await flush(node, sender)
        assert runs[-1].is_checked
        with_listener.close()


async def test_a_change_while_packets_are_handled_applies_to_those_that_were_read_meanwhile(monkeypatch):
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        part, checked = native(node), []
        number = next(iter(part._attached))
        taken = [(number, [], [], True)], (), (), (), part._is_direct

        def deliver(run):
            checked.append(run.is_checked)
            if len(checked) == 1:
                part._revoke((1, 1))

        with monkeypatch.context() as patch:
            patch.setattr(part, "_deliver", deliver)
            patch.setattr(part, "_intake", SimpleNamespace(take=lambda: taken, revoke=lambda source: ()))
            for _ in range(3):
                part._take()
        assert checked == [True, False, True]


async def test_a_channel_is_attached_when_everything_that_was_taken_of_it_was_handled():
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        part = native(node)
        (number,) = part._attached
        part._detach(number, waits=True)
        attached = []
        for _ in range(2):
            part._taken.calls.append(lambda: (part.settle(), attached.append(len(part._attached))))
        part.settle()
        part._taken.handle()
        assert attached == [0, 0]
        part.settle()
        assert part._attached


async def test_a_call_of_what_was_taken_that_handles_the_rest_comes_before_it():
    taken, calls = Taken(), []

    def first() -> None:
        taken.handle()
        calls.append("first")
        taken.calls.append(lambda: calls.append("third"))

    taken.afterwards.append(lambda: calls.append("last"))
    taken.calls += [first, lambda: calls.append("second")]
    assert not taken.is_handled
    taken.handle()
    assert calls == ["first", "second", "third", "last"]
    assert taken.is_handled


async def test_what_follows_a_call_that_fails_is_handled_the_next_time():
    taken, calls = Taken(), []
    taken.calls += [lambda: calls.append(1 / 0), lambda: calls.append("second")]
    with pytest.raises(ZeroDivisionError):
        taken.handle()
    assert not taken.is_handled
    taken.handle()
    assert calls == ["second"]


async def test_a_source_is_granted_after_all_packets_that_were_taken_with_its_first_ones(monkeypatch):
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        part, calls = native(node), []
        (number,) = part._attached
        (packet,) = mavstack.Parser(DIALECT).feed(mavstack.encode(common.VfrHud(), system=1, component=1))
        runs = [(number, [packet], [], False)] * 2
        intake = SimpleNamespace(
            take=lambda: (runs, (), (), (), part._is_direct), grant=lambda *_: calls.append("grant")
        )
        with monkeypatch.context() as patch:
            patch.setattr(part, "_deliver", lambda run: calls.append("deliver"))
            patch.setattr(part, "_intake", intake)
            part._take()
        assert calls == ["deliver", "deliver", "grant", "grant"]


async def test_the_last_boot_time_is_known_after_packets_that_were_left_out():
    async with vehicle_on() as (node, sender), node.events(ComponentRebooted) as reboots:
        await granted(node, sender)
        discovery = node._host.discovery
        for boot_ms in (10_000, 10_020, 10_040):
            sender.send(common.Attitude(time_boot_ms=boot_ms))
            await flush(node, sender)
        tracker = discovery._detectors[1, 1].boot_tracker
        before = tracker._current.seen_at
        names = arrivals(node)
        sender.send(common.Attitude(time_boot_ms=10_060))
        await flush(node, sender)
        assert "ATTITUDE" not in names
        sender.send(common.Attitude(time_boot_ms=500_000))
        await flush(node, sender)
        (current, other) = tracker.boots
        assert (current.since_boot, other.since_boot) == (10.06, 500.0)
        assert before < current.seen_at < other.seen_at
        assert not reboots.drain()


async def test_the_last_boot_time_is_known_when_the_core_parses_a_channel_no_more():
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        for boot_ms in (10_000, 10_020, 10_040):
            sender.send(common.Attitude(time_boot_ms=boot_ms))
            await flush(node, sender)
        tracker, part = node._host.discovery._detectors[1, 1].boot_tracker, native(node)
        assert tracker.boots[0].since_boot < 10.04
        (number,) = part._attached
        part._detach(number, waits=True)
        assert tracker.boots[0].since_boot == 10.04
