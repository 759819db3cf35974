from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.remote_id import Operator, RemoteIdSender
from tests.services.network import GROUND, START
from tests.services.single_service import run_timers

OPERATOR = Operator(47.3977, 8.5456, 488.0, operator_id="FIN87", uas_id="1596F3", description="survey")


def test_the_position_each_second_and_ids_every_ten():
    sent = run_timers(RemoteIdSender(GROUND, 7, OPERATOR, START), START + 10)
    kinds = [type(message).__name__ for _, message in sent]
    complete = ["OpenDroneIdBasicId", "OpenDroneIdOperatorId", "OpenDroneIdSelfId", "OpenDroneIdSystem"]
    assert kinds == [*complete, *["OpenDroneIdSystemUpdate"] * 9, *complete]
    system = next(message for _, message in sent if isinstance(message, common.OpenDroneIdSystem))
    assert (system.target_system, system.operator_latitude, system.operator_altitude_geo) == (
        7,
        473977000,
        488.0,
    )
    assert (system.area_count, system.area_ceiling, system.timestamp) == (
        1,
        -1000.0,
        int(START) - 1_546_300_800,
    )
    basic = sent[0][1]
    assert bytes(basic.uas_id).rstrip(b"\0") == b"1596F3"


def test_an_operator_without_ids():
    sent = run_timers(RemoteIdSender(GROUND, 7, Operator(47.0, 8.0), START), START)
    assert [message.operator_altitude_geo for _, message in sent] == [-1000.0]


@pytest.mark.parametrize(
    "values",
    [
        {"latitude": 91.0},
        {"longitude": float("nan")},
        {"altitude": float("inf")},
        {"operator_id": "x" * 21},
        {"uas_id": "é"},
        {"description": "line\n"},
    ],
)
def test_wrong_operators(values):
    with pytest.raises(InvalidArgumentError):
        Operator(**({"latitude": 47.0, "longitude": 8.0} | values))
