from __future__ import annotations

import pytest

from mavstack.msp import Direction
from mavstack.msp.commands import MspCommand
from tests.sim.msp.peer import Peer

READ, WRITE, DESCRIBE = (
    MspCommand.MSP2_COMMON_SETTING,
    MspCommand.MSP2_COMMON_SET_SETTING,
    MspCommand.MSP2_COMMON_SETTING_INFO,
)


@pytest.fixture
def peer():
    return Peer("inav")


def test_a_setting_is_read_and_written_in_the_width_of_its_type(peer):
    assert peer.request(READ, b"nav_rth_altitude\0").payload == (1000).to_bytes(2, "little")
    assert (
        peer.request(WRITE, b"nav_rth_altitude\0" + (2500).to_bytes(2, "little")).direction
        is Direction.RESPONSE
    )
    assert peer.request(READ, b"nav_rth_altitude\0").payload == (2500).to_bytes(2, "little")
    assert peer.request(READ, b"mc_p_roll\0").payload == bytes([40])
    assert peer.request(READ, b"name\0").payload == b"mavstack\0"
    assert peer.request(WRITE, b"name\0wing\0").direction is Direction.RESPONSE
    assert peer.request(10).payload == b"wing"


def test_wrong_names_and_values_are_refused(peer):
    for command, payload in (
        (READ, b"nonsense\0"),
        (WRITE, b"nav_rth_altitude\0\1"),
        (WRITE, b"nav_rth_allow_landing\0\3"),
        (WRITE, b"deadband\0\xff"),
        (DESCRIBE, b"\0"),
    ):
        assert peer.request(command, payload).direction is Direction.ERROR


def test_a_description_has_type_limits_and_words(peer):
    payload = peer.request(DESCRIBE, b"nav_rth_allow_landing\0").payload
    name, _, rest = payload.partition(b"\0")
    assert name == b"nav_rth_allow_landing"
    assert rest.endswith(b"NEVER\0ALWAYS\0FS_ONLY\0")
    assert int.from_bytes(rest[9:13], "little") == 2
