"""Units of MAVLink fields."""

from __future__ import annotations

import pytest

from mavstack.dialects import Dialect
from mavstack.logs.packets.units import plain_unit


@pytest.mark.parametrize(
    ("unit", "factor", "plain", "result"),
    [
        ("degE7", 1.0, "deg", 1e-7),
        ("cdegC", 1.0, "degC", 0.01),
        ("mV", 1.0, "V", 0.001),
        ("m/s*5", 1.0, "m/s", 0.2),
        ("m/s", 0.01, "m/s", 0.01),
        ("cm", 10.0, "m", 0.1),
        ("mAh", 1.0, "mAh", 1.0),
        ("", 1.0, "", 1.0),
    ],
)
def test_a_unit_and_its_factor(unit, factor, plain, result):
    assert plain_unit(unit, factor) == (plain, pytest.approx(result))


def test_no_unit_of_the_official_definitions_keeps_a_prefix_by_oversight():
    units = {field.units for message in Dialect.load("all") for field in message.definition.fields}
    usual = {"", "%", "A", "Ah", "Hz", "K", "KiB/s", "MHz", "MiB", "MiB/s", "Pa", "V", "W", "bits/s", "bytes"}
    usual |= {"bytes/s", "cm^2", "cm^3", "cm^3/min", "dB", "dBm", "deg", "deg/s", "degC", "g", "gauss", "hPa"}
    usual |= {"kPa", "kg", "l", "m", "m/s", "m/s/s", "mAh", "mbar", "pix", "rad", "rad/s", "rpm", "s"}
    assert {plain_unit(unit, 1.0)[0] for unit in units} - usual <= {"J", "G"}
