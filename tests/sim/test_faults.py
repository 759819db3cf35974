"""Fault injection: parsing, the effect of each fault on both firmwares, and the ways to inject it."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.sim.faults import Fault, FaultError, FaultScript
from mavstack.sim.simulation import Simulation
from tests.sim.harness import VehicleHarness, airborne, grounded

FIRMWARES = ["ardupilot", "px4"]

# Parsing


@pytest.mark.parametrize(
    "text",
    [
        "gps off", "gps on", "GPS  Spoof 10 -20.5", "compass 90", "baro -3", "motor 1 off", "motor 4 on",
        "battery sag 2.5", "battery 30", "radio off", "link on", "reboot",
        "power cycle",
    ],
)  # fmt: skip
def test_a_fault_is_understood(text) -> None:
    assert Fault.parse(text).text == " ".join(text.lower().split())


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "faults are: gps, compass, baro, motor, battery, radio, link, reboot, power"),
        ("wings off", "unknown fault 'wings off'"),
        ("gps", "gps off|on|spoof NORTH EAST"),
        ("gps maybe", "gps off|on|spoof NORTH EAST"),
        ("gps spoof 1", "gps spoof NORTH EAST"),
        ("gps spoof 1 nan", "gps spoof NORTH EAST"),
        ("compass", "compass DEGREES"),
        ("compass 1 2", "compass DEGREES"),
        ("baro x", "baro METRES"),
        ("motor off", "motor NUMBER off|on"),
        ("motor 1.5 off", "1 to 16, got 1.5"),
        ("motor 17 off", "1 to 16, got 17"),
        ("motor 1", "motor NUMBER off|on"),
        ("battery", "battery sag VOLTS, or battery PERCENT"),
        ("battery sag -1", "at least 0 V, got -1"),
        ("battery 101", "0 to 100 percent, got 101"),
        ("radio", "radio off|on"),
        ("link 3", "link off|on"),
        ("reboot now", "usage: reboot"),
        ("power off", "usage: power cycle"),
    ],
)
def test_a_fault_that_is_none_is_explained(text, reason) -> None:
    with pytest.raises(FaultError) as caught:
        Fault.parse(text)
    assert reason in str(caught.value)


def test_a_script_is_sorted_by_time_and_has_comments_and_empty_lines() -> None:
    script = FaultScript(
        ["# all of them", "", "30 gps off", "  12.5 2: motor 1 off  # one of them", "0 reboot"]
    )
    assert [(timed.time, timed.system, timed.fault.text) for timed in script.faults] == [
        (0.0, 0, "reboot"),
        (12.5, 2, "motor 1 off"),
        (30.0, 0, "gps off"),
    ]


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("gps off", "line 2: 'gps off' is not SECONDS [SYSTEM:] FAULT"),
        ("10 x: gps off", "line 2: 'x: gps off' is not"),
        ("-1 gps off", "line 2: -1 is not a time in seconds"),
        ("inf gps off", "line 2: inf is not a time in seconds"),
        ("nan gps off", "line 2: nan is not a time in seconds"),
        ("5 256: gps off", "line 2: system id 256 is outside"),
        ("5 gps sideways", "line 2: usage: gps off|on|spoof NORTH EAST"),
        ("5", "line 2: unknown fault ''"),
    ],
)
def test_a_line_that_is_none_is_named_by_its_number(line, reason) -> None:
    with pytest.raises(FaultError) as caught:
        FaultScript(["1 gps off", line])
    assert str(caught.value).startswith(reason)


WORDS = st.sampled_from(
    [
        *(
            "gps",
            "compass",
            "baro",
            "motor",
            "battery",
            "radio",
            "link",
            "reboot",
            "off",
            "on",
            "spoof",
            "sag",
        ),
        *("0", "1", "2", "-3", "1e999", "nan", "12.5", "2:", ":", "#", "٣"),
    ]
)


@given(st.one_of(st.text(), st.lists(WORDS).map(" ".join)))
def test_any_text_is_a_script_or_is_explained(text) -> None:
    try:
        script = FaultScript(text.splitlines())
    except FaultError:
        return
    assert all(timed.time >= 0 for timed in script.faults)


@given(st.lists(WORDS, max_size=4).map(" ".join))
def test_what_is_understood_can_be_injected(text) -> None:
    try:
        fault = Fault.parse(text)
    except FaultError:
        return
    if fault.kind != "reboot":
        fault.inject(VEHICLE)


VEHICLE = Simulation().add("copter", "ardupilot")


def test_a_script_injects_what_is_due_to_whom_it_means() -> None:
    simulation = Simulation()
    one, two = simulation.add(), simulation.add()
    script = FaultScript(["1 gps off", "2 2: compass 30", "3 gps on"])
    assert script.inject_due(simulation, 0.5) == []
    assert [timed.time for timed in script.inject_due(simulation, 2.0)] == [1.0, 2.0]
    assert one.faults.active == {"gps": "gps off"}
    assert two.faults.active == {"gps": "gps off", "compass": "compass 30"}
    script.inject_due(simulation, 10)
    assert (one.faults.active, two.faults.active) == ({}, {"compass": "compass 30"})
    assert script.inject_due(simulation, 11) == []


# Effects


@pytest.fixture(scope="module", params=FIRMWARES)
def copter(request: pytest.FixtureRequest) -> VehicleHarness:
    return grounded("copter", request.param)


def test_faults_of_several_kinds_are_active_side_by_side_and_end_one_by_one(copter) -> None:
    copter.inject(
        "gps off", "gps spoof 5 5", "motor 1 off", "motor 2 off", "battery sag 1", "compass 20", "baro 2"
    )
    assert set(copter.vehicle.faults.active) == {
        "gps", "gps spoof", "motor 1", "motor 2", "battery sag", "compass", "baro",
    }  # fmt: skip
    copter.inject("gps on", "motor 1 on", "compass 0")
    assert set(copter.vehicle.faults.active) == {"gps spoof", "motor 2", "battery sag", "baro"}
    copter.inject("gps spoof 0 0", "motor 2 on", "battery sag 0", "baro 0")
    assert not copter.vehicle.faults.active


def test_what_a_vehicle_does_not_have_cannot_fail(copter) -> None:
    copter.inject("motor 9 off")
    assert not copter.vehicle.faults.active
    if not copter.autopilot.radio.has_transmitter:
        copter.inject("radio off")
        assert not copter.vehicle.faults.active


def test_satellites(copter) -> None:
    body = copter.vehicle.body
    assert body.sensors.gps_fix >= 3
    copter.inject("gps off").run(0.5)
    assert body.sensors.gps_fix <= 1
    copter.inject("gps on").run(1)
    assert body.sensors.gps_fix >= 3


@pytest.mark.fast_cases(1)
def test_compass_and_barometer(copter) -> None:
    body = copter.vehicle.body
    copter.inject("compass 40", "baro 12").run(8)
    assert body.estimate.yaw - body.truth.yaw == pytest.approx(0.7, abs=0.1)
    assert body.estimate.down - body.truth.down == pytest.approx(12, abs=1)
    copter.inject("compass 0", "baro 0").run(8)
    assert body.estimate.yaw == pytest.approx(body.truth.yaw, abs=0.1)
    assert body.estimate.down == pytest.approx(body.truth.down, abs=1)


def test_battery(copter) -> None:
    body = copter.vehicle.body
    before = body.battery.voltage
    copter.inject("battery sag 2").run(0.5)
    assert body.battery.voltage == pytest.approx(before - 2, abs=0.1)
    copter.inject("battery sag 0", "battery 50").run(0.5)
    assert body.battery.remaining == pytest.approx(0.5, abs=0.01)
    assert body.battery.voltage < before
    copter.inject("battery 100").run(0.5)
    assert body.battery.voltage == pytest.approx(before, abs=0.1)


# Injection by parameters


@pytest.fixture(scope="module")
def tuned() -> VehicleHarness:
    return grounded()


@pytest.mark.parametrize(
    ("name", "value", "fault", "default"),
    [
        ("SIM_GPS1_ENABLE", 0, {"gps": "gps off"}, 1),
        ("SIM_GPS_DISABLE", 1, {"gps": "gps off"}, 0),
        ("SIM_RC_FAIL", 1, {"radio": "radio off"}, 0),
        ("SIM_RC_FAIL", 2, {"radio": "radio off"}, 0),
        ("SIM_MAG_ERROR", 30, {"compass": "compass 30.0"}, 0),
        ("SIM_BARO_GLITCH", -5, {"baro": "baro -5.0"}, 0),
    ],
)
def test_a_simulation_parameter_is_a_fault(tuned, name, value, fault, default) -> None:
    tuned.set_parameter(name, value)
    assert tuned.vehicle.faults.active == fault
    tuned.set_parameter(name, default)
    assert not tuned.vehicle.faults.active


def test_older_and_newer_names_agree(tuned) -> None:
    tuned.set_parameter("SIM_GPS_DISABLE", 1)
    assert tuned.vehicle.parameters["SIM_GPS1_ENABLE"] == 0
    tuned.set_parameter("SIM_GPS1_ENABLE", 1)
    assert tuned.vehicle.parameters["SIM_GPS_DISABLE"] == 0
    tuned.set_parameter("SIM_GPS_GLITCH_X", 0.001)
    assert tuned.vehicle.parameters["SIM_GPS1_GLTCH_X"] == pytest.approx(0.001)
    tuned.run(1)
    assert tuned.vehicle.body.sensors.gps_latitude == pytest.approx(47.3977418 + 0.001, abs=5e-5)
    tuned.set_parameter("SIM_GPS1_GLTCH_X", 0)
    assert not tuned.vehicle.faults.active


def test_engines_fail_by_bits_once_their_multiplier_is_nothing(tuned) -> None:
    tuned.set_parameter("SIM_ENGINE_FAIL", 0b0101)
    assert not tuned.vehicle.faults.active
    tuned.set_parameter("SIM_ENGINE_MUL", 0)
    assert set(tuned.vehicle.faults.active) == {"motor 1", "motor 3"}
    tuned.set_parameter("SIM_ENGINE_FAIL", 0b0010)
    assert set(tuned.vehicle.faults.active) == {"motor 2"}
    tuned.set_parameter("SIM_ENGINE_MUL", 1)
    tuned.set_parameter("SIM_ENGINE_FAIL", 0)
    assert not tuned.vehicle.faults.active


def test_the_battery_gives_less(tuned) -> None:
    tuned.set_parameter("SIM_BATT_VOLTAGE", 14.0)
    tuned.run(0.5)
    assert tuned.vehicle.body.battery.voltage == pytest.approx(14.0, abs=0.1)
    tuned.set_parameter("SIM_BATT_VOLTAGE", 16.8)
    tuned.run(0.5)
    assert not tuned.vehicle.faults.active
    assert tuned.vehicle.body.battery.voltage > 16.5


def test_wind_blows() -> None:
    copter = airborne()
    copter.set_parameter("SIM_WIND_SPD", 8)
    copter.set_parameter("SIM_WIND_DIR", 90)
    copter.run(0.5)
    assert copter.vehicle.body.wind.east == pytest.approx(-8, abs=1)
    copter.set_parameter("SIM_WIND_SPD", 0)
    copter.run(0.5)
    assert copter.vehicle.body.wind.east == 0


def test_values_that_are_no_numbers_do_no_harm(tuned) -> None:
    for name in ("SIM_MAG_ERROR", "SIM_WIND_SPD", "SIM_GPS_GLITCH_X", "SIM_BATT_VOLTAGE", "SIM_ENGINE_MUL"):
        for value in (float("nan"), float("inf"), -1e30):
            tuned.set_parameter(name, value)
        tuned.set_parameter(name, {"SIM_BATT_VOLTAGE": 16.8, "SIM_ENGINE_MUL": 1}.get(name, 0))
    tuned.run(0.5)
