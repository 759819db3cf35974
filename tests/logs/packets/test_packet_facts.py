"""Facts in logs of packets: vehicles, firmware, parameters and texts."""

from __future__ import annotations

import struct

import pytest

import mavstack
from mavstack.dialects import common
from tests.logs.files import encoded, stamped

COPTER = common.Heartbeat(type=2, autopilot=3)
STATION = common.Heartbeat(type=6, autopilot=8)


@pytest.fixture
def log_of(tmp_path):
    def log_of(*messages, system=1, others=()):
        path = tmp_path / "flight"
        path.write_bytes(stamped(encoded(messages, system=system)) + b"".join(others))
        return mavstack.open_log(path, "common", timestamped=True)

    return log_of


def parameter(name, value, kind=9):
    return common.ParamValue(param_id=name, param_value=value, param_type=kind)


def test_vehicles_are_systems_with_an_autopilot(log_of):
    log = log_of(COPTER, COPTER, others=encoded([STATION], system=255))
    vehicle = log.vehicles[1]
    assert list(log.vehicles) == [1]
    assert (vehicle.vehicle_type, vehicle.autopilot, vehicle.heartbeats) == ("QUADROTOR", "ARDUPILOTMEGA", 2)
    assert log.info == {"system": "1", "vehicle_type": "QUADROTOR", "autopilot": "ARDUPILOTMEGA"}


def test_the_firmware_is_that_of_autopilot_version(log_of):
    version = common.AutopilotVersion(
        flight_sw_version=0x040507C1, flight_custom_version=b"abcd1234", board_version=140 << 16, uid=0xBEEF
    )
    info = log_of(COPTER, version).info
    assert info["firmware_version"] == "4.5.7-rc"
    assert (info["firmware_git"], info["hardware"], info["uid"]) == ("abcd1234", "board 140", "beef")
    assert log_of().info == {}


def test_first_values_and_changes_of_parameters(log_of):
    log = log_of(COPTER, parameter("A", 1.5), parameter("B", 3, 4), parameter("A", 1.5), parameter("A", 2))
    assert log.parameters == {"A": 1.5, "B": 3}
    assert isinstance(log.parameters["B"], int)
    (change,) = log.parameter_changes
    assert (change.name, change.before, change.value, change.system) == ("A", 1.5, 2, 1)


@pytest.mark.parametrize("kind", ["autopilot", "capability"])
def test_integer_parameters_of_px4_are_bits(log_of, kind):
    value = struct.unpack("<f", struct.pack("<i", -7))[0]
    heartbeat = common.Heartbeat(type=2, autopilot=12 if kind == "autopilot" else 0)
    version = common.AutopilotVersion(capabilities=0x10 if kind == "capability" else 0)
    assert log_of(heartbeat, version, parameter("N", value, 6)).parameters == {"N": -7}


def test_texts_of_several_messages_are_joined(log_of):
    texts = log_of(
        common.Statustext(severity=4, text="short"),
        common.Statustext(severity=6, text="a" * 50, id=7, chunk_seq=0),
        common.Statustext(severity=6, text="event\t"),
        common.Statustext(severity=6, text="b", id=7, chunk_seq=1),
    ).texts
    assert [text.text for text in texts] == ["short", "a" * 50 + "b", "event"]
    assert [text.severity for text in texts] == [4, 6, 6]


def test_parameters_of_a_payload_are_not_those_of_the_vehicle(log_of):
    gimbal = encoded([parameter("SYSID", 9.0), parameter("ONLY_GIMBAL", 1.0)], component=154)
    log = log_of(COPTER, parameter("SYSID", 1.0), others=gimbal)
    assert (log.parameters, log.parameter_changes) == ({"SYSID": 1.0}, [])


def test_severities_of_apm_until_2015_count_upwards(log_of):
    texts = [
        (1, "Initialising APM..."),
        (2, "medium"),
        (3, "Low Battery!"),
        (4, "critical"),
        (5, "Press a key"),
    ]
    messages = [common.Statustext(severity=severity, text=text) for severity, text in texts]
    other = encoded([common.Statustext(severity=1, text="of another system")], system=2)
    log = log_of(*messages, others=[stamped(other)])
    assert [text.severity for text in log.texts] == [6, 4, 3, 2, 5, 1]
    later = log.select(start=0.0005, end=0.0015)
    assert [text.severity for text in later.texts] == [4]


@pytest.mark.parametrize(
    "texts",
    [((1, "Fly away"), (3, "x")), ((1, "Initialising APM"), (6, "x")), ((1, "Initialising APM"), (0, "y"))],
)
def test_severities_of_other_firmware_stay(log_of, texts):
    log = log_of(*[common.Statustext(severity=severity, text=text) for severity, text in texts])
    assert [text.severity for text in log.texts] == [severity for severity, _ in texts]
