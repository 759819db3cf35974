"""Attacks on a router with firewall and gateway from outside, over real sockets: nothing passes."""

from __future__ import annotations

import sys

import pytest

from tools.attacks.gates import GATES
from tools.attacks.lockouts import LOCKOUTS
from tools.attacks.range import opened
from tools.attacks.routers import available, with_gates, without_firewall, without_signing
from tools.attacks.scenarios import FACTORS, PASSED, PLAIN, UNSIGNED
from tools.attacks.station import STATION, opened_station
from tools.attacks.texts import TEXTS, formulas
from tools.attacks.vehicles import VEHICLES

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(sys.platform != "linux", reason="the tool reads tables of Linux"),
]


@pytest.mark.parametrize("name", PASSED)
def test_no_unauthorised_packet_passes(name):
    (ours,) = available(["mavstack"])
    with opened(ours) as field:
        assert field.command_works()
        assert PASSED[name](field) == 0


@pytest.mark.parametrize(
    ("name", "scenario", "variant"),
    [(name, each, without_signing) for name, each in UNSIGNED.items()]
    + [(name, each, without_firewall) for name, each in PLAIN.items()],
)
def test_nothing_passes_without_signing(name, scenario, variant):
    (ours,) = available(["mavstack"])
    with opened(variant(ours), signed=False) as field:
        assert field.command_works()
        assert scenario(field) == 0, name


#: Large definitions compute for so long that other tests at the same time exceed their limits.
STATION_ATTACKS = [
    pytest.param(name, marks=pytest.mark.nightly if "2.8 MB" in name else ()) for name in STATION
]


@pytest.mark.parametrize("name", STATION_ATTACKS)
def test_errors_of_a_station_do_not_reveal_files(name):
    with opened_station() as field:
        assert STATION[name](field) == 0


def test_texts_in_csv_are_no_formulas():
    assert formulas(TEXTS["mavstack"]) == 0


@pytest.mark.parametrize("name", LOCKOUTS)
def test_clients_with_a_credential_are_not_locked_out(name):
    with opened(with_gates()) as field:
        assert field.command_works()
        assert LOCKOUTS[name](field) == 0


@pytest.mark.parametrize("name", VEHICLES)
def test_a_vehicle_serves_its_pilot(name):
    assert VEHICLES[name]() == 0


def test_an_invented_address_gets_no_more_than_three_times_the_bytes():
    (ours,) = available(["mavstack"])
    with opened(without_firewall(ours), signed=False) as field:
        assert field.command_works()
        assert FACTORS["no firewall: reflected bytes for each byte"](field) <= 3


@pytest.mark.parametrize("name", GATES)
def test_no_gate_lets_anything_unauthorised_through(name):
    with opened(with_gates()) as field:
        assert field.command_works()
        assert GATES[name](field) == 0
