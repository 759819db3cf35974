"""Each rule on a flight with its fault, and all rules on a sound one."""

from __future__ import annotations

from importlib.metadata import EntryPoint, EntryPoints

import pytest

from mavstack import open_log
from mavstack.dialects import common
from mavstack.logs.analysis import Finding, Rule, Severity, all_rules, analyse, flights
from mavstack.plugins import Registry
from mavstack.wire import Encoder
from tests.logs.analysis.telemetry import ARMED, during, flight_tlog
from tests.logs.files import stamped


@pytest.fixture
def findings_of(tmp_path):
    def run(change=lambda telemetry: None) -> dict[str, list[Finding]]:
        path = tmp_path / "flight.tlog"
        path.write_bytes(flight_tlog(change))
        (flight,) = flights(open_log(path))
        found: dict[str, list[Finding]] = {}
        for finding in analyse(flight):
            found.setdefault(finding.rule, []).append(finding)
        return found

    return run


def test_a_sound_flight_has_no_findings(findings_of):
    assert findings_of() == {}


def clipped(telemetry):
    telemetry.clipping = max(int(telemetry.time) - 20, 0) * 5


def parameter(telemetry):
    if telemetry.time in (1.0, 30.0):
        telemetry.parameters = (("RTL_ALT", 1500.0 if telemetry.time == 1.0 else 3000.0),)


FULL_MOTOR = (1990, 1510, 1500, 1500)
FAULTS = {
    "strong vibration": ("vibration", Severity.CRITICAL, during(10, 50, vibration=70.0), 10),
    "some vibration": ("vibration", Severity.WARNING, during(10, 50, vibration=40.0), 10),
    "clipping": ("clipping", Severity.CRITICAL, clipped, 21),
    "lost fix": ("gps_quality", Severity.CRITICAL, during(20, 22, fix=1), 20),
    "few satellites": ("gps_quality", Severity.WARNING, during(20, 22, satellites=4), 20),
    "high HDOP": ("gps_quality", Severity.WARNING, during(20, 40, hdop=4.0), 20),
    "a jump": ("gps_glitch", Severity.CRITICAL, during(30, 31, north=800.0), 30),
    "compass": ("estimator", Severity.CRITICAL, during(20, 25, ratio=1.3), 20),
    "sag": ("voltage_sag", Severity.CRITICAL, during(40, 50, voltage=9.0), 40),
    "low charge": ("charge", Severity.WARNING, during(45, 50, remaining=15), 45),
    "empty": ("charge", Severity.CRITICAL, during(45, 50, remaining=5), 45),
    "brown-out": ("board_supply", Severity.CRITICAL, during(45, 46, board=4.2), 45),
    "ends in flight": ("ends_in_flight", Severity.WARNING, during(50, 60, armed=True, altitude=20.0), 59.9),
    "saturation": (
        "motor_saturation",
        Severity.CRITICAL,
        during(20, 40, outputs=(1990, 1510, 1500, 1500)),
        20,
    ),
    "imbalance": ("motor_imbalance", Severity.WARNING, during(5, 55, outputs=(1300, 1600, 1600, 1300)), None),
    "upside down": ("crash", Severity.CRITICAL, during(30, 31, roll=3.0), 30),
    "crash text": ("crash", Severity.CRITICAL, during(30, 30.1, texts=((2, "Crash: Disarming"),)), 30),
    "failsafe": ("failsafes", Severity.CRITICAL, during(30, 30.1, texts=((4, "Radio Failsafe"),)), 30),
    "refused mode": (
        "mode_failures",
        Severity.WARNING,
        during(30, 30.1, texts=((4, "Mode change to LOITER failed"),)),
        30,
    ),
    "refused mode of PX4": (
        "mode_failures",
        Severity.WARNING,
        during(30, 30.1, texts=((2, "Switching to Mission is currently not available"),)),
        30,
    ),
    "error": ("errors", Severity.WARNING, during(30, 30.1, texts=((3, "Baro: not healthy"),)), 30),
    "silence": ("lost_link", Severity.WARNING, during(20, 28, heard=False), 19),
    "noise": ("radio_margin", Severity.WARNING, during(20, 30, noise=190), 20),
    "parameter": ("parameter_changes", Severity.INFO, parameter, 30),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_found(findings_of, name):
    rule, severity, change, time = FAULTS[name]
    found = findings_of(change)
    assert rule in found, f"{rule}: found only {sorted(found)}"
    finding = found[rule][0]
    assert finding.severity is severity
    assert finding.title
    assert finding.text.endswith((".", "Disarming", "Failsafe", "healthy", "failed", "available"))
    assert finding.time is None if time is None else finding.time == pytest.approx(time, abs=0.2)
    usual = {rule, "motor_imbalance"} if rule == "motor_saturation" else {rule}
    assert set(found) <= usual, "no other rule takes this fault for its own"


#: Faults that are none while the vehicle is disarmed: a bench test, a battery that is changed, a start-up.
ON_THE_GROUND = {
    "vibration": 70.0,
    "clipping": 500,
    "fix": 1,
    "satellites": 3,
    "hdop": 9.0,
    "ratio": 1.5,
    "voltage": 5.0,
    "remaining": 3,
    "noise": 190,
    "roll": 3.0,
    "outputs": (1990, 1000, 1000, 1000),
    "north": 5000.0,
}


@pytest.mark.parametrize("name", ON_THE_GROUND)
def test_nothing_is_found_before_arming(findings_of, name):
    assert findings_of(during(0, ARMED - 1, **{name: ON_THE_GROUND[name]})) == {}


@pytest.mark.parametrize(
    "text",
    [
        "Failsafe activated: offboard control lost",
        "Radio Failsafe - Continuing Landing",
        "Battery Failsafe, sending home",
    ],
)
def test_a_failsafe_is_found_whatever_it_mentions(findings_of, text):
    (finding,) = findings_of(during(30, 30.1, texts=((4, text),)))["failsafes"]
    assert finding.title == text


@pytest.mark.parametrize(
    "text",
    [
        "EKF Failsafe Cleared",
        "Throttle failsafe off",
        "PreArm: Radio failsafe on",
        "Arm: Throttle below failsafe",
        "PreArm: CrashDump data detected",
    ],
)
def test_a_failsafe_that_ended_or_kept_the_vehicle_on_the_ground_is_none(findings_of, text):
    assert findings_of(during(30, 30.1, texts=((6, text),))) == {}


def test_a_vehicle_without_satellites_needs_none(findings_of):
    assert findings_of(during(0, 60, fix=0, satellites=0, hdop=99.0)) == {}


def test_noise_of_the_position_is_no_jump(findings_of):
    assert findings_of(during(30, 30.1, north=40.0)) == {}, "20 m in a tenth of a second"


def test_an_altitude_that_was_last_sent_in_the_air_is_no_end(tmp_path):
    encoder, packets = Encoder(1, 1), []
    for second in range(60):
        packets.append(encoder.encode(common.Heartbeat(type=2, autopilot=3, base_mode=129)))
        if second < 30:
            packets.append(encoder.encode(common.GlobalPositionInt(relative_alt=20_000)))
    path = tmp_path / "flight.tlog"
    path.write_bytes(stamped(packets, step=500_000))
    (flight,) = flights(open_log(path))
    assert [finding.rule for finding in analyse(flight)] == []


def test_a_repeated_text_is_one_finding(findings_of):
    found = findings_of(during(20, 40, texts=((4, "Radio Failsafe"), (2, "Crash: Disarming"))))
    assert [finding.time for finding in found["failsafes"] + found["crash"]] == pytest.approx(
        [20, 20], abs=0.1
    )


def test_values_that_stand_for_unknown_have_no_time(findings_of):
    def unknown_first(telemetry):
        telemetry.remaining = -1 if telemetry.time < 20 else 15
        telemetry.voltage = 0.5 if 10 <= telemetry.time < 11 else 9.0 if telemetry.time > 30 else 12.4

    found = findings_of(unknown_first)
    assert found["charge"][0].time == pytest.approx(20, abs=0.1)
    assert found["voltage_sag"][0].time == pytest.approx(30, abs=0.2)


def test_the_heartbeats_of_a_payload_do_not_hide_a_lost_link(tmp_path):
    autopilot, camera = Encoder(1, 1), Encoder(1, 100)
    beat = common.Heartbeat(type=2, autopilot=3, base_mode=129)
    camera_beat = common.Heartbeat(type=common.MavType.CAMERA, autopilot=common.MavAutopilot.INVALID)
    packets = []
    for second in range(60):
        packets.append(camera.encode(camera_beat))
        packets.append(
            (camera if 20 <= second < 40 else autopilot).encode(camera_beat if 20 <= second < 40 else beat)
        )
    path = tmp_path / "silent.tlog"
    path.write_bytes(stamped(packets, step=500_000))
    (flight,) = flights(open_log(path))
    (finding,) = analyse(flight)
    assert (finding.rule, round(finding.numbers["max_gap_s"])) == ("lost_link", 21)


def test_two_links_with_counters_of_their_own_are_no_loss(tmp_path):
    first, second = Encoder(1, 1), Encoder(1, 1)
    beat = common.Heartbeat(type=2, autopilot=3)
    for _ in range(100):
        second.encode(beat)
    packets = [encoder.encode(beat) for _ in range(200) for encoder in (first, second)]
    path = tmp_path / "two.tlog"
    path.write_bytes(stamped(packets))
    (flight,) = flights(open_log(path))
    assert analyse(flight) == []


def test_packets_that_are_missing_are_counted(tmp_path):
    encoder = Encoder(1, 1)
    beat = common.Heartbeat(type=2, autopilot=3)
    packets = [encoder.encode(beat) for _ in range(100)]
    path = tmp_path / "loss.tlog"
    path.write_bytes(stamped([packet for number, packet in enumerate(packets) if number % 5]))
    (flight,) = flights(open_log(path))
    (finding,) = analyse(flight)
    assert finding.rule == "packet_loss"
    assert finding.numbers["share"] == pytest.approx(0.2, abs=0.02)


def test_findings_are_ranked_and_can_be_written(findings_of, tmp_path):
    flight_rules = [rule.name for rule in all_rules()]
    assert len(flight_rules) == len(set(flight_rules)) >= 17
    (flight,) = flights(open_log(_heartbeat_log(tmp_path)))

    def check(_):
        yield Finding("own", Severity.INFO, "later", "Later.", 5.0)
        yield Finding("own", Severity.CRITICAL, "grave", "Grave.", None, {"value_m": 1.23456789})
        yield Finding("own", Severity.INFO, "earlier", "Earlier.", 1.0)

    found = analyse(flight, [Rule("own", "A rule of another package.", check)])
    assert [finding.title for finding in found] == ["grave", "earlier", "later"]
    assert found[0].to_dict() == {
        "rule": "own",
        "severity": "critical",
        "title": "grave",
        "text": "Grave.",
        "time_s": None,
        "numbers": {"value_m": 1.234568},
    }


def _heartbeat_log(folder):
    path = folder / "beat.tlog"
    path.write_bytes(stamped([Encoder(1, 1).encode(common.Heartbeat(type=2, autopilot=3))]))
    return path


def test_samples_clipped_while_disarmed_do_not_count(findings_of):
    def change(telemetry):
        telemetry.armed = 5 <= telemetry.time < 20 or 40 <= telemetry.time < 55
        telemetry.clipping = 500 if telemetry.time >= 30 else 0

    assert "clipping" not in findings_of(change)


def test_a_counter_that_begins_again_takes_nothing_back(findings_of):
    def change(telemetry):
        telemetry.clipping = 40 if 20 <= telemetry.time < 30 else 0

    (finding,) = findings_of(change)["clipping"]
    assert (finding.numbers, finding.time) == ({"samples": 40.0}, pytest.approx(20.0, abs=0.1))


def test_a_plugin_that_cannot_be_loaded_keeps_no_rule_out(monkeypatch, caplog):
    targets = {"lost": "no_such_module:RULE", "wrong": "json:loads", "own": f"{__name__}:OWN_RULE"}
    entries = EntryPoints(
        EntryPoint(name, value, "mavstack.analysis_rules") for name, value in targets.items()
    )
    builtin = all_rules()
    monkeypatch.setattr(Registry, "plugins", lambda registry: entries)
    assert all_rules() == (*builtin, OWN_RULE)
    assert [record.message.partition(" was left out")[0] for record in caplog.records] == [
        "plug-in lost",
        "plug-in wrong",
    ]


OWN_RULE = Rule("own", "Finds nothing.", lambda _flight: ())
