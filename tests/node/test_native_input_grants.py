"""Packets that were left to the thread before a grant was revoked are checked by the engine."""

from __future__ import annotations

import os
from types import SimpleNamespace

import pytest

from mavstack.dialects import common
from tests.node.test_native_input import flush, granted, native, vehicle_on

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
