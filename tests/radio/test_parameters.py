"""Parameters: numbers in order, valid values, and the shared ones."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.radio import PARAMETERS, SHARED, check_value
from mavstack.radio.simulator import DEFAULTS


def test_numbers_follow_each_other():
    assert [each.number for each in PARAMETERS.values()] == list(range(16))


def test_the_defaults_of_the_firmware_are_valid():
    for parameter, value in zip(PARAMETERS.values(), DEFAULTS, strict=True):
        if parameter.writable:
            parameter.check(value)


def test_shared_parameters():
    hopping = {"NETID", "MIN_FREQ", "MAX_FREQ", "NUM_CHANNELS", "LBT_RSSI", "MAX_WINDOW"}
    assert hopping | {"AIR_SPEED", "ECC", "MANCHESTER"} == SHARED


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("FORMAT", 26, "the firmware sets it"),
        ("SERIAL_SPEED", 56, "the values are 1, 2, 4"),
        ("LBT_RSSI", 24, r"25 to 220, or 0 \(off\)"),
        ("TXPOWER", 31, "0 to 30 dBm"),
        ("UNKNOWN", -1, "0 to 4294967295"),
    ],
)
def test_invalid_values(name, value, words):
    with pytest.raises(InvalidArgumentError, match=words):
        check_value(name, value)


def test_zero_and_unknown_parameters_are_left_to_the_radio():
    check_value("LBT_RSSI", 0)
    check_value("MIN_FREQ", 0)
    check_value("ENCRYPTION_LEVEL", 1)
