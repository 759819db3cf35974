"""PX4's logs, read by pyulog."""

from __future__ import annotations

from math import cos, isnan, nan, sin, sqrt

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.sim.storage import UlogWriter, navigation_state
from mavstack.sim.storage.ulog_format import Topic
from mavstack.sim.storage.ulog_topics import TOPICS
from tests.sim.storage.samples import (
    BOOT,
    HOME,
    ITEM,
    Health,
    Motion,
    Sensors,
    any_float,
    any_sample,
    log_start,
    read_ulog,
    sample,
    values_of,
)

T0 = 9_000_000
MISSION, LOITER = 4 << 16 | 4 << 24, 4 << 16 | 3 << 24


def start(**changes):
    return log_start(firmware="PX4 v1.16.0", version=(1, 16, 0), **changes)


def whole_log(**changes) -> bytes:
    writer = UlogWriter(start(), T0)
    for step in range(5):
        writer.write(sample(T0 + step * 100_000, mode=MISSION, **changes))
    writer.text(T0 + 500_000, 4, "Low battery")
    writer.parameter(T0 + 500_000, "MPC_XY_CRUISE", 7.5)
    writer.parameter(T0 + 500_000, "COM_RC_LOSS_T", 3)
    writer.event(T0 + 500_000, 1234)
    writer.mode(T0 + 500_000, LOITER)
    writer.armed(T0 + 500_000, False)
    writer.error(T0, 1, 1)
    writer.command(T0, ITEM, 0, 1)
    return bytes(writer.data)


@pytest.fixture
def log(capfd):
    found = read_ulog(whole_log())
    assert capfd.readouterr().out == "", "pyulog found nothing wrong"
    return found


def close(values, place=0, **expected) -> None:
    for name, value in expected.items():
        assert values[name][place] == pytest.approx(value, rel=1e-6, abs=1e-6), name


def test_header(log) -> None:
    assert log.start_timestamp == T0
    assert log.last_timestamp == T0 + 500_000
    assert log.msg_info_dict == {
        "ver_sw": "1f2e3d4c",
        "ver_sw_release": 0x011000FF,
        "ver_hw": "SITL",
        "sys_name": "PX4",
        "sys_os_name": "Linux",
        "sys_uuid": f"{7:036x}",
        "ver_data_format": 2,
        "time_ref_utc": 0,
        "boot_time_utc_us": int(BOOT * 1e6),
    }
    assert log.get_version_info_str() == "v1.16.0"


def test_parameters(log) -> None:
    assert log.initial_parameters == {"ARMING_CHECK": 1, "WPNAV_SPEED": 750.0, "A_NAME_OF_16_LET": -3}
    assert log.has_default_parameters
    assert log.get_default_parameters(0) == {"WPNAV_SPEED": 1000.0, "A_NAME_OF_16_LET": 0}
    assert [(name, value) for _, name, value in log.changed_parameters] == [
        ("MPC_XY_CRUISE", 7.5),
        ("COM_RC_LOSS_T", 3),
    ]


def test_texts(log) -> None:
    (message,) = log.logged_messages
    assert (message.timestamp, message.log_level_str(), message.message) == (
        T0 + 500_000,
        "WARNING",
        "Low battery",
    )


def test_all_topics_are_present(log) -> None:
    assert {data.name for data in log.data_list} == set(TOPICS)
    for topic in TOPICS.values():
        fields = [(field.type, field.count if field.count > 1 else 0, field.name) for field in topic.fields]
        assert log.message_formats[topic.name].fields == fields
    lengths = {data.name: len(data.data["timestamp"]) for data in log.data_list}
    fast = ("vehicle_attitude", "vehicle_local_position", "sensor_combined", "vehicle_angular_velocity")
    assert {lengths[name] for name in fast} == {5}
    assert lengths["vehicle_gps_position"] == lengths["battery_status"] == lengths["airspeed"] == 3
    assert lengths["vehicle_status"] == lengths["mission_result"] == lengths["home_position"] == 1


def test_motion(log) -> None:
    motion = sample().motion
    attitude = values_of(log, "vehicle_attitude")
    w, x, y, z = (attitude[f"q[{place}]"][0] for place in range(4))
    assert sqrt(w * w + x * x + y * y + z * z) == pytest.approx(1)
    # the third row of the rotation matrix gives roll and pitch, the first column pitch and yaw
    assert 2 * (x * z - w * y) == pytest.approx(-sin(motion.pitch), abs=1e-6)
    assert 2 * (y * z + w * x) == pytest.approx(sin(motion.roll) * cos(motion.pitch), abs=1e-6)
    assert 2 * (x * y + w * z) == pytest.approx(sin(motion.yaw) * cos(motion.pitch), abs=1e-6)
    position = values_of(log, "vehicle_local_position")
    close(position, x=12.5, y=-7.25, z=-20.5, vx=3.5, vy=-1.5, vz=0.5, z_deriv=0.5, ax=0.125, ay=-0.25)
    close(position, az=0.0625, heading=-1.2, ref_lat=HOME[0], ref_lon=HOME[1], ref_alt=HOME[2], evh=0.2)
    close(position, xy_valid=1, z_valid=1, xy_global=1, dist_bottom_valid=0, dead_reckoning=0)
    assert isnan(position["dist_bottom"][0])
    assert position["timestamp"] == [T0 + step * 100_000 for step in range(5)]
    close(values_of(log, "vehicle_angular_velocity"), **{"xyz[0]": 0.01, "xyz[1]": -0.02, "xyz[2]": 0.03})
    close(values_of(log, "vehicle_global_position"), lat=47.397855, lon=8.545498, alt=508.5, alt_valid=1)


def test_sensors(log) -> None:
    combined = values_of(log, "sensor_combined")
    close(combined, **{"gyro_rad[0]": 0.01, "accelerometer_m_s2[2]": -9.75}, gyro_integral_dt=5000)
    gps = values_of(log, "vehicle_gps_position")
    close(gps, latitude_deg=47.3978541, longitude_deg=8.5454981, altitude_msl_m=508.51, vel_m_s=5.0)
    close(gps, fix_type=3, satellites_used=14, eph=0.71, epv=1.12, vel_d_m_s=0.5, vel_ned_valid=1)
    assert gps["time_utc_usec"][1] == int(BOOT * 1e6) + T0 + 200_000
    close(values_of(log, "vehicle_air_data"), baro_pressure_pa=95550.0, ambient_temperature=21.25)
    close(values_of(log, "airspeed"), indicated_airspeed_m_s=14.5, true_airspeed_m_s=14.5, confidence=1)
    battery = values_of(log, "battery_status")
    close(battery, voltage_v=15.5, current_a=12.25, discharged_mah=731.5, remaining=0.86, cell_count=4)
    close(battery, warning=0, connected=1, temperature=31.5)
    rc = values_of(log, "input_rc")
    close(rc, channel_count=8, rc_lost=0, **{"values[0]": 1500, "values[7]": 1300, "values[8]": 0})
    close(values_of(log, "actuator_outputs"), **{"output[0]": 1100, "output[15]": 1250}, noutputs=16)
    close(values_of(log, "home_position"), lat=HOME[0], lon=HOME[1], alt=HOME[2], valid_hpos=1)
    close(values_of(log, "event"), id=1234, event_sequence=1)


def test_status(log) -> None:
    status = values_of(log, "vehicle_status")
    close(status, nav_state=3, nav_state_user_intention=3, arming_state=2, armed_time=T0, takeoff_time=T0)
    close(status, vehicle_type=1, system_type=2, system_id=7, component_id=1, failsafe=0, is_vtol=0)
    close(values_of(log, "vehicle_land_detected"), landed=0, horizontal_movement=1, at_rest=0)
    close(values_of(log, "mission_result"), seq_current=1, seq_total=2, seq_reached=0, finished=0, valid=1)


def test_status_is_written_when_it_changes() -> None:
    writer = UlogWriter(start(vehicle=common.MavType.VTOL_FIXEDROTOR), 0)
    changes = [{}, {}, {"armed": True}, {"landed": False}, {"mode": LOITER}, {"mission_reached": 1}, {}]
    state = {"armed": False, "landed": True, "mode": MISSION}
    for step, change in enumerate(changes):
        state |= change  # type: ignore[call-overload]
        writer.write(sample(step * 100_000, **state))
    for step in range(7, 17):
        writer.write(sample(step * 100_000, **(state | {"armed": False, "landed": True})))
    log = read_ulog(bytes(writer.data))
    status = values_of(log, "vehicle_status")
    assert status["timestamp"] == [0, 200_000, 300_000, 400_000, 500_000, 700_000]
    assert status["arming_state"] == [1, 2, 2, 2, 2, 1]
    assert status["armed_time"] == [0, 200_000, 200_000, 200_000, 200_000, 0]
    assert status["nav_state_timestamp"] == [0, 0, 0, 400_000, 400_000, 400_000]
    assert status["latest_disarming_reason"][-1] == 6
    assert set(status["is_vtol"]) == {1}
    assert values_of(log, "mission_result")["finished"] == [0, 0, 0, 0, 1, 1]


def test_lost_position_and_radio() -> None:
    health = Health(horizontal=False)
    log = read_ulog(whole_log(health=health, rc=(), sensors=Sensors(distance=3.25, gps_fix=0)))
    close(values_of(log, "vehicle_local_position"), xy_valid=0, z_valid=1, dead_reckoning=1, dist_bottom=3.25)
    close(values_of(log, "input_rc"), rc_lost=1, channel_count=0, rssi=0)
    close(values_of(log, "vehicle_gps_position"), vel_ned_valid=0, fix_type=0)


@pytest.mark.parametrize(
    ("main", "sub", "state"),
    [(1, 0, 0), (2, 0, 1), (3, 0, 2), (3, 1, 21), (4, 2, 17), (4, 3, 4), (4, 4, 3), (4, 5, 5), (4, 6, 18),
     (4, 8, 19), (4, 9, 20), (4, 10, 22), (5, 0, 10), (6, 0, 14), (7, 0, 15), (10, 0, 13), (4, 11, 23),
     (99, 9, 0)],
)  # fmt: skip
def test_navigation_states(main, sub, state) -> None:
    assert navigation_state(main << 16 | sub << 24) == state


def test_invalid_table_is_refused() -> None:
    with pytest.raises(ValueError, match="invalid field"):
        Topic(0, "x", "uint64_t")


@pytest.mark.flight
@settings(max_examples=60)
@given(samples=st.lists(any_sample(), max_size=3))
def test_random_samples_are_written(samples) -> None:
    writer = UlogWriter(start(), 0)
    for each in samples:
        writer.write(each)
    writer.text(5, 6, "after it all")
    log = read_ulog(bytes(writer.data))
    assert [message.message for message in log.logged_messages] == ["after it all"]
    if samples:
        assert len(values_of(log, "vehicle_attitude")["timestamp"]) == len(samples)


@pytest.mark.flight
@settings(max_examples=60)
@given(
    time=st.integers(-(2**70), 2**70),
    number=st.integers(-(2**70), 2**70),
    text=st.text(max_size=300),
    value=any_float() | st.integers(-(2**70), 2**70),
    place=st.tuples(any_float(), any_float(), any_float()),
)
def test_random_events_are_written(time, number, text, value, place) -> None:
    writer = UlogWriter(start(git_hash=text, board=text, home=place), 0)
    writer.text(time, number, text)
    writer.event(time, number)
    writer.parameter(time, "A_NAME", value)
    writer.home(time, *place)
    writer.text(7, 6, "after it all")
    log = read_ulog(bytes(writer.data))
    assert [message.message for message in log.logged_messages][-1] == "after it all"


def test_nan_attitude_is_written_as_nan() -> None:
    log = read_ulog(whole_log(motion=Motion(roll=nan)))
    assert isnan(values_of(log, "vehicle_attitude")["q[0]"][0])
    close(values_of(log, "vehicle_local_position"), x=12.5)
