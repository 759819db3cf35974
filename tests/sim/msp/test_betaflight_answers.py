from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import pytest

from mavstack.msp import Direction
from mavstack.msp.messages.battery import BatteryState, CurrentMeters, VoltageMeters
from mavstack.msp.messages.config import GetText, NamedText, Rtc, SetRtc, SetText
from mavstack.msp.messages.identification import Name
from mavstack.msp.messages.modes import BoxIds, BoxNames, ModeRanges, ModeRangesExtra, SetModeRange
from mavstack.msp.messages.motors import MotorTelemetry
from mavstack.msp.messages.osd import OsdConfig, SetOsdConfig, SetOsdItem, SetOsdTimer
from mavstack.msp.messages.pid import CopyProfile, Pid, ResetCurrentPid, SelectSetting
from mavstack.msp.messages.registry import all_messages, request_types
from mavstack.msp.messages.status import StatusEx
from mavstack.msp.messages.vtx import (
    GetVtxTableBand,
    GetVtxTablePowerLevel,
    SetVtxConfig,
    VtxConfig,
    VtxTableBand,
    VtxTablePowerLevel,
)
from tests.sim.msp.peer import Peer

if TYPE_CHECKING:
    from mavstack.msp.messages.layout import TableMessage


@pytest.fixture
def peer():
    return Peer()


def stored_pairs() -> list[tuple[type[TableMessage], type[TableMessage]]]:
    """Return the messages that read settings, each with the one that writes them."""
    store, pairs = Peer().controller.system.settings, []
    for written in all_messages():
        if written.IS_REPLY or "BTFL" not in written.VARIANTS:
            continue
        names = {written.NAME.replace("_SET_", "_", 1)}
        pairs += [(read, written) for read in all_messages() if read.NAME in names and read in store]
    return [(read, written) for read, written in pairs if issubclass(written, read)]


@pytest.mark.parametrize(("read", "written"), stored_pairs(), ids=lambda kind: kind.__name__)
def test_a_message_of_the_settings_is_written_as_it_was_read(peer, read, written):
    before = peer.get(read)
    assert peer.write(written.from_message(before))
    assert peer.get(read) == before


def test_twenty_messages_or_more_are_settings():
    assert len(stored_pairs()) >= 20


def test_every_reply_of_the_registry_that_is_answered_can_be_decoded(peer):
    answered = 0
    for kind in all_messages():
        if not kind.IS_REPLY or "BTFL" not in kind.VARIANTS or kind.COMMAND in (68, 208, 245):
            continue
        reply = peer.request(kind.COMMAND)
        if reply is not None and reply.direction is Direction.RESPONSE and not request_types(kind.COMMAND):
            kind.decode(reply.payload, peer.controller.info)
            answered += 1
    assert answered >= 55


def test_boxes_are_paged_and_the_status_has_their_bits(peer):
    names, ids = peer.get(BoxNames).names, peer.get(BoxIds).ids
    assert names[:3] == ("ARM", "ANGLE", "HORIZON")
    assert len(names) == len(ids)
    assert peer.get(BoxNames, b"\1").names == ()
    assert peer.get(StatusEx).extra_mode_flags == b""


def test_mode_ranges(peer):
    assert peer.write(SetModeRange(6, 13, 2, 1300, 1700, 1, 0))
    assert peer.get(ModeRanges).ranges[6].start == 1300
    assert peer.get(ModeRangesExtra).ranges[6].logic == 1
    assert not peer.write(SetModeRange(20, 13, 2, 1300, 1700))
    assert not peer.write(SetModeRange(6, 200, 2, 1300, 1700))


def test_texts_and_clock(peer):
    assert peer.write(SetText(2, "racer"))
    assert peer.get(Name).name == "racer"
    assert peer.get(NamedText, GetText(2).encode()).text == "racer"
    assert not peer.write(SetText(5, "key"))
    assert peer.get(Rtc) == Rtc()
    assert peer.write(SetRtc(1_700_000_000, 500))
    assert peer.get(Rtc).year == 2023


def test_display(peer):
    assert peer.write(SetOsdItem(3, 2433, 1))
    assert peer.get(OsdConfig).items[3] == 2433
    assert peer.write(SetOsdItem(5, 1, 0))
    assert peer.get(OsdConfig).statistics[5] == 1
    assert peer.write(SetOsdTimer(index=1, timer=7))
    assert peer.get(OsdConfig).timers[1] == 7
    assert peer.write(SetOsdConfig.from_message(dataclasses.replace(peer.get(OsdConfig), altitude_alarm=55)))
    assert peer.get(OsdConfig).altitude_alarm == 55
    assert not peer.write(SetOsdItem(200, 1, 1))


def test_video_transmitter(peer):
    assert peer.get(VtxTableBand, GetVtxTableBand(5).encode()).frequencies[0] == 5658
    assert peer.get(VtxTablePowerLevel, GetVtxTablePowerLevel(2).encode()).label == "100"
    assert peer.write(SetVtxConfig(combined=3 * 8 + 1, power=2, pit_mode=False))
    config = peer.get(VtxConfig)
    assert (config.band, config.channel, config.frequency, config.power) == (4, 2, 5760, 2)
    assert peer.request(137, b"\6").direction is Direction.ERROR


def test_profiles(peer):
    assert peer.write(SelectSetting(1))
    assert peer.get(StatusEx).pid_profile == 1
    assert peer.write(SelectSetting(0x80 | 2))
    assert peer.get(StatusEx).rate_profile == 2
    assert peer.write(CopyProfile(0, 1, 0))
    assert peer.write(ResetCurrentPid())
    assert peer.get(Pid).controllers[0].p == 45


def test_meters_agree(peer):
    peer.run(0.1)
    volts = peer.get(BatteryState).voltage
    assert volts == pytest.approx(16.8, abs=0.1)
    assert peer.get(VoltageMeters).meters[0].voltage == pytest.approx(volts, abs=0.1)
    assert peer.get(CurrentMeters).meters[0].current > 0
    assert len(peer.get(MotorTelemetry).motors) == 4


def test_several_requests_in_one(peer):
    reply = peer.request(230, bytes([2, 108]))
    assert reply.payload[:5] == b"\4BTFL"
    assert reply.payload[5] == 6
    assert peer.request(230, bytes([2, 7])).direction is Direction.ERROR


def test_requests_that_are_too_short_are_refused(peer):
    for command in (35, 99, 0x3006, 0x3007, 85, 89, 183, 246, 210):
        assert peer.request(command).direction is Direction.ERROR, command
