"""The messages that act upon a vehicle."""

from __future__ import annotations

import pytest

from mavstack.dialects import Dialect, common
from mavstack.security.acting import ACTING, acting_ids, acting_names, acts
from mavstack.security.roles import Role, allows
from tests.docs.blocks import ROOT

ARM = common.CommandLong(target_system=1, target_component=1, command=common.MavCmd.COMPONENT_ARM_DISARM)
CARRIERS = ACTING["command"].split()


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (ARM, True),
        (common.ParamSet(), True),
        (common.ParamRequestRead(), False),
        (ARM.replace(command=common.MavCmd.REQUEST_MESSAGE), False),
        (common.FileTransferProtocol(payload=bytes([0, 0, 0, 5])), False),
        (common.FileTransferProtocol(payload=bytes([0, 0, 0, 7])), True),
        (common.ManualControl(), True),
        (common.MissionRequestList(), False),
        (common.GpsRtcmData(), False),
        (common.Heartbeat(), False),
    ],
)
def test_messages_that_act(message, expected):
    assert acts(message) is expected


def test_each_message_exists_and_has_one_kind():
    names = [name for kind in ACTING.values() for name in kind.split()]
    assert len(set(names)) == len(names)
    assert len(acting_ids()) == len(names)


def test_every_message_of_the_table_acts():
    dialect = Dialect.load("all")
    quiet = {"FILE_TRANSFER_PROTOCOL", *CARRIERS}  # judged by their content
    assert {name for name in acting_names() if not acts(dialect[name]())} <= quiet


@pytest.mark.parametrize("name", sorted(acting_names()))
def test_an_observer_sends_none(name):
    number = Dialect.load("all")[name].definition.id
    assert not allows(Role.OBSERVE, number, int(common.MavCmd.COMPONENT_ARM_DISARM))


def test_the_documentation_lists_them():
    page = (ROOT / "docs" / "reference" / "firewall.md").read_text("utf-8")
    listed = page.partition("## Acting messages")[2].split("|---|---|")[1]
    rows = [line.split("|")[2] for line in listed.splitlines() if line.startswith("|")]
    assert [set(row.replace(",", " ").split()) for row in rows] == [
        set(kind.split()) for kind in ACTING.values()
    ]
