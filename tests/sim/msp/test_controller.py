from __future__ import annotations

import pytest

from mavstack.msp import Direction
from mavstack.msp.messages.actions import EepromWrite, Reboot, ResetConf
from mavstack.msp.messages.identification import (
    ApiVersion,
    BoardInfo,
    BuildInfo,
    FcVariant,
    FcVersion,
    Name,
    Uid,
    firmware_info,
)
from mavstack.msp.messages.pid import Gains, Pid, SetPid
from mavstack.msp.messages.sensors import Attitude
from mavstack.sim import Simulation
from mavstack.sim.faults import TimedFault
from mavstack.sim.msp.controller import EEPROM_FILE
from tests.sim.msp.peer import Peer

IDENTITY = (ApiVersion, FcVariant, FcVersion, BoardInfo, BuildInfo, Name, Uid)


def set_gains(peer: Peer, p: int) -> None:
    gains = peer.get(Pid).controllers
    assert peer.write(SetPid((Gains(p, gains[0].i, gains[0].d), *gains[1:])))


@pytest.mark.parametrize(
    ("firmware", "variant", "version"), [("betaflight", "BTFL", "4.5.2"), ("inav", "INAV", "8.0.1")]
)
def test_identification(firmware, variant, version):
    peer = Peer(firmware)
    info = firmware_info({kind: peer.get(kind) for kind in IDENTITY})
    assert (info.variant, info.version_text, info.name) == (variant, version, "mavstack")
    assert info.api == peer.controller.info.api


@pytest.mark.parametrize("firmware", ["betaflight", "inav"])
def test_saved_settings_outlive_a_reboot_and_others_do_not(firmware):
    peer = Peer(firmware)
    set_gains(peer, 61)
    assert peer.write(EepromWrite())
    set_gains(peer, 62)
    assert peer.write(Reboot())
    peer.run(0.5)
    assert peer.request(2) is None
    peer.run(1.0)
    assert peer.get(Pid).controllers[0].p == 61
    assert peer.controller.boots == 2
    assert peer.write(ResetConf())
    assert peer.get(Pid).controllers[0].p != 61


def test_the_eeprom_of_a_folder_outlives_the_program(tmp_path):
    first = Peer(storage=tmp_path)
    set_gains(first, 63)
    first.write(EepromWrite())
    assert (tmp_path / "1" / EEPROM_FILE).stat().st_size > 0
    assert Peer(storage=tmp_path).get(Pid).controllers[0].p == 63


def test_an_armed_controller_neither_saves_nor_reboots():
    peer = Peer()
    peer.arm()
    assert not peer.write(EepromWrite())
    assert not peer.write(Reboot())
    assert not peer.write(ResetConf())


def test_equal_seeds_and_input_give_equal_bytes():
    def flight() -> bytes:
        peer = Peer(seed=3)
        peer.transmit(7.0)
        return b"".join(peer.request(command).payload for command in (102, 106, 108, 109, 110, 150))

    assert flight() == flight()


def test_faults_reach_it():
    peer = Peer()
    for text in ("gps off", "compass 90", "radio off"):
        TimedFault.parse(f"1: {text}").inject(peer.simulation)
    peer.run(6.0)
    assert 80 < peer.get(Attitude).heading < 100
    assert not peer.controller.has_fix
    peer.transmit(1.0)
    assert "RX_FAILSAFE" in peer.controller.arming_disable_reasons
    TimedFault.parse("link off").inject(peer.simulation)
    assert peer.request(2) is None
    TimedFault.parse("link on").inject(peer.simulation)
    assert peer.request(2).direction is Direction.RESPONSE


def test_numbers_are_shared_with_vehicles_that_speak_mavlink():
    simulation = Simulation()
    simulation.add()
    assert simulation.add_flight_controller("inav").address.system == 2
    assert [each.address.system for each in simulation.fault_targets] == [1, 2]


def test_a_closed_port_gives_its_lock_of_arming_back():
    peer = Peer()
    assert peer.request(99, b"\1").direction is Direction.RESPONSE
    peer.run(0.1)
    assert "MSP" in peer.controller.arming_disable_reasons
    peer.controller.close_port(peer.port)
    peer.run(0.1)
    assert "MSP" not in peer.controller.arming_disable_reasons
