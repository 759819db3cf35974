"""The conversations of simulated calibrations, beside those of a real ArduCopter (4.1-dev)."""

from __future__ import annotations

from itertools import groupby

from mavstack.dialects import ardupilotmega, common

from .harness import CMD, ArdupilotHarness

POSITION, SUCCESS = CMD.ACCELCAL_VEHICLE_POS, int(ardupilotmega.AccelcalVehiclePos.SUCCESS)
STATUS = ardupilotmega.MagCalStatus
#: Texts, requested positions and steps of the real vehicle, without repetitions.
ACCELEROMETER = [
    "Place vehicle level and press any key.",
    1,
    2,
    3,
    4,
    5,
    6,
    "Calibration successful",
    SUCCESS,
]
COMPASS = [STATUS.RUNNING_STEP_ONE, STATUS.RUNNING_STEP_TWO, STATUS.SUCCESS]


def conversation(harness: ArdupilotHarness) -> list[object]:
    """Return the texts, positions and steps that were received, without repetitions."""
    values: list[object] = []
    for message in harness.received:
        match message:
            case common.CommandLong(command=command, param1=position) if command == POSITION:
                values.append(int(position))
            case common.Statustext(text=text) if "alibration" in text or "Place" in text:
                values.append(text)
            case ardupilotmega.MagCalProgress(cal_status=status) | common.MagCalReport(cal_status=status):
                values.append(status)
    return [value for value, _ in groupby(values)]


def test_accelerometer() -> None:
    harness = ArdupilotHarness("copter")
    harness.received.clear()
    harness.accepted(CMD.PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 1, wait=1.5)
    for position in range(1, 7):
        harness.accepted(POSITION, position, wait=1.5)
    assert conversation(harness) == ACCELEROMETER


def test_compass() -> None:
    harness = ArdupilotHarness("copter")
    harness.received.clear()
    harness.accepted(CMD.DO_START_MAG_CAL, 0, 0, 1, wait=14)
    assert conversation(harness) == COMPASS
    (progress, *_), reports = (
        harness.received_of(ardupilotmega.MagCalProgress),
        harness.received_of(common.MagCalReport),
    )
    assert (progress.attempt, progress.cal_mask) == (1, 1)
    assert len(reports) > 2  # until the next calibration
    assert reports[0].autosaved
