"""Attacks on a router with firewall and gateway from outside, over real sockets: nothing passes."""

from __future__ import annotations

import sys

import pytest

from tools.attacks.gates import GATES
from tools.attacks.range import opened
from tools.attacks.routers import available, with_gates
from tools.attacks.scenarios import PASSED

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(sys.platform != "linux", reason="the tool reads tables of Linux"),
]


def test_no_unauthorised_packet_passes():
    (ours,) = available(["mavstack"])
    passed = {}
    for name, scenario in PASSED.items():
        with opened(ours) as field:
            assert field.command_works()
            passed[name] = scenario(field)
    assert passed == dict.fromkeys(PASSED, 0)


@pytest.mark.parametrize("name", GATES)
def test_no_gate_lets_anything_unauthorised_through(name):
    with opened(with_gates()) as field:
        assert field.command_works()
        assert GATES[name](field) == 0
