"""Binary logs whose definitions give known names to unexpected types."""

from __future__ import annotations

import random

import numpy as np
import pytest

from mavstack import open_log
from tests.logs.dataflash.writer import LogWriter, random_values
from tests.logs.exercise import exercise

#: Record types that have a meaning beyond their own definition, with the columns that are read of them.
KNOWN = {
    "GPS": "TimeUS,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd",
    "POS": "TimeUS,Lat,Lng,Alt,RelHomeAlt",
    "ATT": "TimeUS,DesRoll,Roll,DesPitch,Pitch,Yaw",
    "PARM": "TimeUS,Name,Value",
    "MSG": "TimeUS,Message,ID,Seq",
    "VER": "TimeUS,Maj,Min,Pat,GH",
    "MODE": "TimeUS,Mode,ModeNum",
    "ARM": "TimeUS,ArmState",
    "EV": "TimeUS,Id",
    "ERR": "TimeUS,Subsys,ECode",
    "CMD": "TimeUS,CNum,CId,Frame,Prm1,Prm2,Prm3,Prm4,Lat,Lng,Alt",
    "ACC": "TimeUS,AccX,AccY,AccZ",
    "IMU": "TimeUS,AccX,AccY,AccZ",
    "BAT": "TimeUS,Volt,Curr,RemPct",
    "XKF4": "TimeUS,SV,SP,SM",
    "VIBE": "TimeUS,VibeX,VibeY,VibeZ,Clip",
    "RCOU": "TimeUS,C1,C2,C3,C4",
    "FMTU": "TimeUS,FmtType,UnitIds,MultIds",
    "UNIT": "TimeUS,Id,Label",
    "MULT": "TimeUS,Id,Mult",
}


@pytest.mark.filterwarnings("ignore:.*encountered in:RuntimeWarning")
@pytest.mark.parametrize("seed", range(6))
def test_known_names_with_any_types(tmp_path, seed):
    rng = random.Random(seed)
    types = []
    for number, (name, labels) in enumerate(KNOWN.items(), 1):
        columns = [label for label in labels.split(",") if seed % 3 or rng.random() < 0.8] or ["TimeUS"]
        letters = "".join("Q" if rng.random() < 0.5 else rng.choice("aBhiIqdfnNZcLM") for _ in columns)
        types.append((number, name, letters[:16], ",".join(columns)))
    log = LogWriter([kind for kind in types if kind[1] != "FMTU"])
    log.define(129, "FMTU", *next(kind[2:] for kind in types if kind[1] == "FMTU"))
    for _, name, letters, _ in types:
        for _ in range(12):
            log.write(name, *random_values(rng, letters))
    path = tmp_path / "log.BIN"
    path.write_bytes(log.data)
    with np.errstate(all="ignore"):
        exercise(open_log(path), tmp_path)


def test_a_damaged_parameter_is_no_system_id(tmp_path):
    for value in (float("nan"), float("inf"), -3.0, 1e30):
        log = LogWriter()
        log.write("PARM", 1000, "SYSID_THISMAV", value, 1.0)
        path = tmp_path / "log.BIN"
        path.write_bytes(log.data)
        read = open_log(path)
        assert list(read.vehicles) == [0]
        assert "system" not in read.info


def test_a_value_that_is_no_number_does_not_change(tmp_path):
    log = LogWriter()
    for value in (float("nan"), float("nan"), 1.0):
        log.write("PARM", 1000, "X", value, 1.0)
    path = tmp_path / "log.BIN"
    path.write_bytes(log.data)
    assert [change.value for change in open_log(path).parameter_changes] == [1.0]


@pytest.mark.parametrize(
    ("utc_s", "leap_s"), [(1_341_100_799, 15), (1_341_100_800, 16), (1_435_708_800, 17), (1_483_228_800, 18)]
)
def test_leap_seconds_are_those_of_the_day(tmp_path, utc_s, leap_s):
    log = LogWriter()
    # `gps` writes 18 leap seconds.
    log.gps(5_000_000, utc_s * 1_000_000 - 5_000_000 + (leap_s - 18) * 1_000_000)
    path = tmp_path / "log.BIN"
    path.write_bytes(log.data)
    assert open_log(path)["GPS"]["_time"][0] == np.datetime64(utc_s, "s")
