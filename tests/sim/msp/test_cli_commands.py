from __future__ import annotations

import pytest

from mavstack.msp.messages.pid import Pid
from mavstack.msp.messages.rc import RxMap
from mavstack.sim.msp.boxes import ModeRange
from tests.sim.msp.peer import Peer


@pytest.fixture
def peer():
    peer = Peer()
    peer.enter_cli()
    return peer


def test_settings_are_shown_with_profile_limits_and_default(peer):
    assert peer.cli("get p_roll") == "p_roll = 45\nprofile 0\nAllowed range: 0 - 250\n"
    assert peer.cli("set p_roll = 46") == "p_roll set to 46"
    assert peer.cli("set p_roll").endswith("Allowed range: 0 - 250\nDefault value: 45\n")
    values = "BETAFLIGHT, RACEFLIGHT, KISS, ACTUAL, QUICK"
    assert peer.cli("get rates_type") == f"rates_type = ACTUAL\nrateprofile 0\nAllowed values: {values}\n"
    assert peer.cli("get craft_name") == "craft_name = mavstack\nString length: 1 - 16\n"


def test_wrong_values_and_names_are_refused(peer):
    assert peer.cli("set p_roll = 999") == "###ERROR IN set: INVALID VALUE###\nAllowed range: 0 - 250\n"
    assert peer.cli("set nonsense = 1") == "###ERROR IN set: INVALID NAME###\n"
    assert peer.cli("get nonsense") == "###ERROR IN get: INVALID NAME: nonsense###\n"
    assert "INVALID VALUE" in peer.cli("set rates_type = FOO")
    assert "OUTSIDE OF [0..3]" in peer.cli("profile 4")
    assert "INVALID RC MAP" in peer.cli("map AAAA")
    assert "INVALID NAME" in peer.cli("feature WINGS")
    for line in (
        "aux 1 2",
        "aux 99 0 0 900 900",
        "aux 1 255 0 900 900",
        "aux 1 0 0 1 900",
        "aux 1 0 9999 1700 2100",
        "aux 1 0 -1 1700 2100",
        "aux 1 0 0 1700 2100 2",
        "aux 1 0 0 1700 2100 0 255",
    ):
        assert "###ERROR IN aux" in peer.cli(line)


def test_units_of_messages_are_those_of_the_firmware_in_the_cli(peer):
    assert peer.cli("get gps_rescue_ascend_rate").startswith("gps_rescue_ascend_rate = 750\n")
    assert peer.cli("get failsafe_delay").startswith("failsafe_delay = 15\n")
    peer.cli("set failsafe_delay = 20")
    assert peer.controller.system.failsafe.delay == 2.0


def test_a_setting_of_the_cli_is_in_the_messages(peer):
    peer.cli("set d_yaw = 7")
    peer.cli("map TAER1234")
    peer.connect()
    assert peer.get(Pid).controllers[2].d == 7
    assert peer.get(RxMap).positions[:4] == (1, 2, 3, 0)


def test_a_mode_range(peer):
    assert peer.cli("aux 5 13 2 1700 2100 0 0") == "aux 5 13 2 1700 2100 0 0"
    assert peer.controller.system.settings.mode_ranges[5] == ModeRange(13, 2, 32, 48)
    assert "\naux 5 13 2 1700 2100 0 0\n" in peer.cli("aux")


def test_state_and_help(peer):
    assert peer.cli("version").startswith("# Betaflight / STM32F405 (S405) 4.5.2 ")
    assert (
        peer.cli("status").splitlines()[-1]
        == "Arming disable flags: RXFAILSAFE BOOTGRACETIME CALIBRATING CLI"
    )
    assert peer.cli("help prof").startswith("profile - change profile")
    assert peer.cli("help xyz") == "NO MATCHES FOR 'xyz'\n"
    assert peer.cli("feature").startswith("Enabled:  GPS TELEMETRY RX_MSP OSD")


def test_save_keeps_settings_over_the_reboot_and_exit_does_not():
    peer = Peer()
    for ending, kept in (("save", 46), ("exit", 46)):
        peer.enter_cli()
        peer.cli(f"set p_roll = {kept if ending == 'save' else 99}")
        assert peer.cli(ending).endswith("Rebooting")
        peer.run(1.5)
        assert peer.get(Pid).controllers[0].p == kept
        assert not peer.port.has_cli


def test_settings_are_not_saved_while_armed():
    peer = Peer()
    peer.arm()
    peer.enter_cli()
    assert peer.cli("save") == "###ERROR IN save: CANNOT SAVE WHILE ARMED###\n"


@pytest.mark.parametrize("firmware", ["betaflight", "inav"])
def test_a_dump_names_every_setting_and_a_diff_none_of_the_defaults(firmware):
    peer = Peer(firmware)
    peer.enter_cli()
    dump = peer.cli("dump")
    settings = [each.name for each in peer.controller.system.cli_settings]
    assert len(settings) > 60
    assert [name for name in settings if f"\nset {name} = " not in dump] == []
    assert "\nset " not in peer.cli("diff all")


@pytest.mark.parametrize("firmware", ["betaflight", "inav"])
def test_the_text_of_a_diff_restores_another_controller(firmware):
    first, second = Peer(firmware), Peer(firmware)
    first.enter_cli()
    gain = "p_roll" if firmware == "betaflight" else "mc_p_roll"
    for line in (
        f"set {gain} = 77",
        "set deadband = 7",
        "aux 7 1 3 1300 1700 0 0",
        "feature -GPS",
        "map TAER",
    ):
        first.cli(line)
    first.cli("profile 1")
    first.cli(f"set {gain} = 78")
    text = first.cli("diff all")
    second.enter_cli()
    for line in text.splitlines()[:-1]:
        assert "###ERROR" not in second.cli(line), line
    assert second.cli("diff all") == text
    assert second.cli("save").endswith("Rebooting")


def test_a_channel_map_that_the_firmware_cannot_hold():
    peer = Peer("inav")
    peer.enter_cli()
    assert "INVALID RC MAP" in peer.cli("map 1234AETR")
    assert "map AETR" in peer.cli("map")
