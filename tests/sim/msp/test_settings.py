from __future__ import annotations

import dataclasses

import pytest

from mavstack.msp import Frame, FrameVersion
from mavstack.msp.messages.navigation import LAST_WAYPOINT_FLAG, WaypointAction, Wp
from mavstack.msp.messages.pid import Gains, Pid
from mavstack.msp.messages.rc import FailsafeConfig, FailsafeProcedure, RcTuning, SetRcTuning
from mavstack.sim.msp.betaflight_settings import betaflight_facts
from mavstack.sim.msp.boxes import ModeRange
from mavstack.sim.msp.settings import SettingStore


def changed_store() -> SettingStore:
    store = SettingStore(betaflight_facts())
    store.select(2, is_rate_profile=False)
    gains = store.get(Pid).controllers
    store.put(Pid((Gains(99, 1, 2), *gains[1:])))
    store.put(dataclasses.replace(store.get(FailsafeConfig), procedure=FailsafeProcedure.GPS_RESCUE))
    store.named["pwr_on_arm_grace"] = 7
    store.mode_ranges[4] = ModeRange(46, 3, 32, 48, 1, 0)
    return store


def test_the_eeprom_keeps_everything():
    waypoint = Wp(1, WaypointAction.LAND, 47.0, 8.0, 12.0, 1, 2, 1, LAST_WAYPOINT_FLAG)
    content = changed_store().encode([waypoint])
    restored = SettingStore(betaflight_facts())
    assert restored.decode(content) == [waypoint]
    assert restored.get(Pid).controllers[0] == Gains(99, 1, 2)
    assert restored.get(FailsafeConfig).procedure is FailsafeProcedure.GPS_RESCUE
    assert restored.named["pwr_on_arm_grace"] == 7
    assert restored.mode_ranges == changed_store().mode_ranges
    restored.select(0, is_rate_profile=False)
    assert restored.get(Pid) == restored.default(Pid)


def test_damage_costs_what_is_damaged():
    content = bytearray(changed_store().encode())
    content[content.index(b"pwr_on") + 2] ^= 0xFF
    restored = SettingStore(betaflight_facts())
    restored.decode(bytes(content) + b"$X>\0 cut")
    assert restored.named["pwr_on_arm_grace"] == 5
    assert restored.get(FailsafeConfig).procedure is FailsafeProcedure.GPS_RESCUE


@pytest.mark.parametrize("command", [0xFF00, 0xFF01, 35, 118, Pid.COMMAND])
@pytest.mark.parametrize("payload", [b"", b"\xff\xff\xff", b"pwr_on_arm_grace=x", bytes(range(40))])
def test_frames_of_the_eeprom_with_other_content_are_skipped(command, payload):
    store, frame = SettingStore(betaflight_facts()), Frame(command, payload, version=FrameVersion.V2)
    store.decode(frame.encode() + changed_store().encode())
    assert store.mode_ranges == changed_store().mode_ranges


def test_a_written_message_changes_the_fields_that_it_has():
    store = SettingStore(betaflight_facts())
    tuning = store.get(RcTuning)
    store.update(
        RcTuning, dataclasses.replace(SetRcTuning.from_message(tuning), yaw_rate=40, rates_type=None)
    )
    assert store.get(RcTuning) == dataclasses.replace(tuning, yaw_rate=40)


def test_a_profile_is_copied():
    store = SettingStore(betaflight_facts())
    store.put(Pid((Gains(9, 9, 9),)))
    store.copy_profile(1, 0, is_rate_profile=False)
    store.copy_profile(9, 0, is_rate_profile=False)
    store.select(1, is_rate_profile=False)
    assert store.get(Pid) == Pid((Gains(9, 9, 9),))
