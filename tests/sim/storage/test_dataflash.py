"""ArduPilot's logs, read by pymavlink."""

from __future__ import annotations

import struct
from math import degrees, nan

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.sim.storage import DataflashWriter
from mavstack.sim.storage.dataflash_formats import FORMATS, MULTIPLIERS, UNITS
from tests.sim.storage.samples import (
    BOOT,
    HOME,
    ITEM,
    PARAMETERS,
    any_float,
    any_sample,
    log_start,
    read_dataflash,
    sample,
)

T0 = 9_000_000


def whole_log() -> bytes:
    writer = DataflashWriter(log_start(), T0)
    for step in range(5):
        writer.write(sample(T0 + step * 100_000))
    now = T0 + 500_000
    writer.text(now, 6, "Reached waypoint #1")
    writer.mode(now, 4, 2)
    writer.armed(now, False, method=2)
    writer.event(now, 18)
    writer.error(now, 11, 2)
    writer.parameter(now, "WPNAV_SPEED", 500.5, 1000.0)
    writer.command(now, ITEM, 1, 2)
    writer.home(now, 1.5, -2.5, 100.25)
    return bytes(writer.data)


@pytest.fixture
def found(tmp_path, capfd):
    messages = read_dataflash(whole_log(), tmp_path)
    assert capfd.readouterr() == ("", ""), "pymavlink found nothing wrong"
    return messages


def test_all_messages_are_present(found) -> None:
    assert set(found) == set(FORMATS)
    assert {name: len(found[name]) for name in ("FMT", "FMTU", "UNIT", "MULT")} == {
        "FMT": len(FORMATS),
        "FMTU": len(FORMATS),
        "UNIT": len(UNITS),
        "MULT": len(MULTIPLIERS),
    }
    for name in ("ATT", "POS", "IMU", "XKF1"):
        assert len(found[name]) == 5, name
    for name in ("GPS", "GPA", "BARO", "BAT", "MAG", "RCIN", "RCOU", "XKF4", "ARSP"):
        assert [message["TimeUS"] for message in found[name]] == [T0, T0 + 200_000, T0 + 400_000], name


@pytest.mark.parametrize("kind", FORMATS.values(), ids=FORMATS)
def test_format_is_consistent(kind) -> None:
    fields = kind.labels.split(",")
    assert len(fields) == len(kind.format) == len(kind.units) == len(kind.multipliers)
    assert len(kind.labels) <= 64
    assert len(kind.format) <= 16
    assert set(kind.units) <= set(UNITS)
    assert set(kind.multipliers) <= set(MULTIPLIERS)
    assert kind.length == 3 + struct.calcsize("<" + kind.codes) < 256


def test_format_numbers_are_unique() -> None:
    assert len({kind.type for kind in FORMATS.values()}) == len(FORMATS)


def close(message, **values) -> None:
    for name, value in values.items():
        assert message[name] == pytest.approx(value, rel=1e-6, abs=1e-6), name


def test_motion(found) -> None:
    motion = sample().motion
    yaw = degrees(motion.yaw) + 360
    close(
        found["ATT"][0],
        TimeUS=T0,
        DesRoll=degrees(0.12),
        Roll=degrees(motion.roll),
        DesPitch=degrees(motion.pitch),
        Pitch=degrees(motion.pitch),
        DesYaw=yaw,
        Yaw=yaw,
        AEKF=3,
    )
    close(found["POS"][0], Lat=47.397855, Lng=8.545498, Alt=508.5, RelHomeAlt=20.5, RelOriginAlt=20.5)
    estimate = found["XKF1"][0]
    close(estimate, VN=3.5, VE=-1.5, VD=0.5, PN=12.5, PE=-7.25, PD=-20.5, OH=488.0)
    assert estimate["Roll"] == pytest.approx(degrees(motion.roll), abs=0.005)
    assert estimate["Yaw"] == pytest.approx(yaw, abs=0.005)


def test_sensors(found) -> None:
    close(found["IMU"][0], I=0, GyrX=0.01, GyrY=-0.02, GyrZ=0.03, AccX=0.5, AccY=-0.25, AccZ=-9.75, T=21.25)
    close(found["MAG"][0], MagX=215, MagY=11, MagZ=424, Health=1)
    close(found["BARO"][0], Press=95550.0, Temp=21.25, CRt=-0.5, Alt=20.5, H=1)
    close(found["ARSP"][0], Airspeed=14.5, DiffPress=150.0, Temp=21.25, U=1)
    close(found["RCIN"][0], C1=1500, C2=1510, C8=1300, C9=0, C14=0)
    close(found["RCOU"][0], C1=1100, C14=1230)
    close(found["XKF4"][0], SV=5, SP=7, SH=2, SM=11)
    close(found["BAT"][0], Inst=0, Volt=15.5, Curr=12.25, CurrTot=731.5, Temp=31.5, RemPct=86, EnrgTot=0.0)
    assert found["BAT"][2]["EnrgTot"] == pytest.approx(15.5 * 12.25 * 0.4 / 3600, rel=1e-5)


def test_gps(found) -> None:
    gps = found["GPS"][0]
    close(gps, Status=3, NSats=14, HDop=0.71, Lat=47.3978541, Lng=8.5454981, Alt=508.51, Spd=5.0, VZ=0.5)
    assert gps["GCrs"] == pytest.approx(306.8699, abs=1e-3)
    gps_time = gps["GWk"] * 604_800 + gps["GMS"] / 1000 + 315_964_800 - 18
    assert gps_time == pytest.approx(BOOT + T0 / 1e6)
    close(found["GPA"][0], HAcc=0.71, VAcc=1.12, VV=1)


def test_events(found) -> None:
    assert [message["Message"] for message in found["MSG"]] == [
        "ArduCopter V4.6.0 (1f2e3d4c)",
        "Reached waypoint #1",
    ]
    assert [(message["ModeNum"], message["Rsn"]) for message in found["MODE"]] == [(5, 0), (4, 2)]
    close(found["ARM"][0], ArmState=0, Method=2, Forced=0)
    assert [message["Id"] for message in found["EV"]] == [11, 18]
    close(found["ERR"][0], Subsys=11, ECode=2)
    assert [
        (message["Type"], message["Lat"], message["Lng"], message["Alt"]) for message in found["ORGN"]
    ] == [
        (0, *HOME),
        (1, *HOME),
        (1, 1.5, -2.5, 100.25),
    ]
    close(found["VER"][0], Maj=4, Min=6, Pat=0, GH=0x1F2E3D4C)
    assert found["VER"][0]["FWS"] == "ArduCopter V4.6.0 (1f2e3d4c)"


def test_parameters_and_mission(found) -> None:
    parameters = [(message["Name"], message["Value"], message["Default"]) for message in found["PARM"]]
    assert parameters == [
        *((name, value, default) for name, value, default in PARAMETERS),
        ("WPNAV_SPEED", 500.5, 1000.0),
    ]
    assert [message["CNum"] for message in found["CMD"]] == [0, 1, 1]
    close(found["CMD"][1], CTot=2, CId=16, Prm1=1.5, Lat=47.3980001, Lng=8.5460002, Alt=60.0, Frame=3)


def test_units(tmp_path) -> None:
    from pymavlink.DFReader import DFReader_binary

    path = tmp_path / "log.BIN"
    path.write_bytes(whole_log())
    reader = DFReader_binary(str(path))
    while reader.recv_msg() is not None:
        pass
    formats = {kind.name: kind for kind in reader.formats.values()}
    assert formats["GPS"].get_unit("Alt") == "m"
    assert formats["MAG"].get_unit("MagX") == "mGauss"
    assert formats["BAT"].get_unit("CurrTot") == "mAh"
    assert formats["IMU"].get_unit("GyrX") == "rad/s"
    reader.filehandle.close()


def test_no_airspeed_record_without_airspeed(tmp_path) -> None:
    writer = DataflashWriter(log_start(), 0)
    writer.write(sample(0, airspeed=0.0, rc=(), health=None))
    found = read_dataflash(bytes(writer.data), tmp_path)
    assert "ARSP" not in found
    assert found["RCIN"][0]["C1"] == 0


def test_texts_are_cut_at_whole_characters(tmp_path) -> None:
    writer = DataflashWriter(log_start(), 0)
    writer.text(0, 6, "x" * 63 + "é" + "\0y")
    writer.parameter(0, "NAME_OF_MORE_THAN_SIXTEEN", nan, 0)
    found = read_dataflash(bytes(writer.data), tmp_path)
    assert found["MSG"][-1]["Message"] == "x" * 63
    assert found["PARM"][-1]["Name"] == "NAME_OF_MORE_THA"


@pytest.mark.nightly
@pytest.mark.flight
@settings(max_examples=60)
@given(samples=st.lists(any_sample(), max_size=3))
def test_random_samples_are_written(samples, tmp_path_factory) -> None:
    writer = DataflashWriter(log_start(), 0)
    for each in samples:
        writer.write(each)
    writer.text(5, 6, "after it all")
    found = read_dataflash(bytes(writer.data), tmp_path_factory.mktemp("any"))
    assert len(found["ATT"]) == len(found["POS"]) == len(samples)
    assert found["MSG"][-1]["Message"] == "after it all"


@pytest.mark.flight
@settings(max_examples=60)
@given(
    time=st.integers(-(2**70), 2**70),
    number=st.integers(-(2**70), 2**70),
    text=st.text(max_size=90),
    value=any_float() | st.integers(-(2**70), 2**70),
    place=st.tuples(any_float(), any_float(), any_float()),
)
def test_random_events_are_written(time, number, text, value, place, tmp_path_factory) -> None:
    writer = DataflashWriter(log_start(git_hash=text, home=place, mode=number), 0)
    writer.text(time, number, text)
    writer.mode(time, number, number)
    writer.armed(time, True, method=number)
    writer.event(time, number)
    writer.error(time, number, number)
    writer.parameter(time, text, value)
    writer.command(time, ITEM, number, number)
    writer.home(time, *place)
    writer.text(7, 6, "after it all")
    found = read_dataflash(bytes(writer.data), tmp_path_factory.mktemp("any"))
    assert found["MSG"][-1]["Message"] == "after it all"
    assert found["MSG"][-1]["TimeUS"] == 7
