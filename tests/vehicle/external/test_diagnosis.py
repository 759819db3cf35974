from __future__ import annotations

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.vehicle.external.diagnosis import EstimatorFacts, ExternalStatus, find_reasons

APM, PX4 = common.MavAutopilot.ARDUPILOTMEGA, common.MavAutopilot.PX4
POSE = frozenset({"position", "yaw"})
GOOD_APM = {"VISO_TYPE": 1, "AHRS_EKF_TYPE": 3, "EK3_SRC1_POSXY": 6}
GOOD_PX4 = {"EKF2_EV_CTRL": 15, "EKF2_DELAY_MAX": 200, "EKF2_EV_QMIN": 0}
FLAGS = 8 | 16


def reasons(autopilot: int, parameters: dict[str, float], **facts: object) -> str:
    status = common.EstimatorStatus(flags=FLAGS) if autopilot == PX4 else None
    status = status or ardupilotmega.EkfStatusReport(flags=FLAGS)
    values = {"parts": POSE, "rate": 30.0, "delay": 0.02, "parameters": parameters, "status": status}
    return "; ".join(find_reasons(EstimatorFacts(autopilot, **(values | facts))))


def test_nothing_speaks_against_it():
    assert reasons(APM, GOOD_APM) == reasons(PX4, GOOD_PX4) == ""
    assert reasons(common.MavAutopilot.GENERIC, {}) == ""


@pytest.mark.parametrize(
    ("autopilot", "changes", "facts", "text"),
    [
        (APM, {}, {"parts": frozenset()}, "nothing was sent"),
        (APM, {}, {"rate": 2.0}, "it comes at 2.0 Hz, and the firmware needs 3.3 Hz"),
        (PX4, {}, {"rate": 4.0}, "it comes at 4.0 Hz, and the firmware needs 5.0 Hz"),
        (APM, {"VISO_TYPE": 0}, {}, "VISO_TYPE is 0: set it to 1"),
        (APM, {"AHRS_EKF_TYPE": 2}, {}, "AHRS_EKF_TYPE is 2: set it to 3"),
        (APM, {"EK3_SRC1_POSXY": 3}, {}, "EK3_SRC1_POSXY is 3 (GPS): set it to 6"),
        (PX4, {"EKF2_EV_CTRL": 0}, {}, "EKF2_EV_CTRL is 0"),
        (PX4, {"EKF2_EV_CTRL": 4}, {}, "EKF2_EV_CTRL is 4, without the bits of what is sent (3 or 8)"),
        (PX4, {}, {"delay": 0.3}, "it is 300 ms old, and EKF2_DELAY_MAX is 200 ms"),
        (PX4, {"EKF2_EV_QMIN": 30}, {"quality": 20}, "its quality is 20, and EKF2_EV_QMIN is 30"),
        (PX4, {}, {"status": None}, "sends neither ESTIMATOR_STATUS nor EKF_STATUS_REPORT"),
        (PX4, {}, {"status": common.EstimatorStatus(flags=1)}, "ESTIMATOR_STATUS has no horizontal position"),
        (PX4, {}, {"status": common.EstimatorStatus(flags=8)}, "the estimator has no origin"),
        (
            APM,
            {},
            {"status": ardupilotmega.EkfStatusReport(flags=FLAGS, pos_horiz_variance=1.5)},
            "EKF_STATUS_REPORT rejects the position: test ratio 1.5",
        ),
    ],
)
def test_each_reason(autopilot, changes, facts, text):
    good = GOOD_APM if autopilot == APM else GOOD_PX4
    found = reasons(autopilot, good | changes, **facts)
    assert text in found
    assert ";" not in found


def test_missing_visual_odometry_is_named():
    assert "VISO_TYPE was not found" in reasons(APM, {})


def test_the_words():
    assert str(ExternalStatus(1, 30.0, 0.01, None, ())) == "the estimator uses it"
    status = ExternalStatus(0, 0.0, None, None, ("a", "b"))
    assert str(status) == "the estimator does not use it: a; b"
    assert not status.is_used
