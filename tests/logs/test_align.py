"""Resampling and as-of joins, compared with numpy and pandas."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mavstack
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, UnknownMessageError
from mavstack.logs import align
from tests.logs.files import START, encoded

moments = st.lists(st.integers(0, 40), min_size=1, max_size=12)
tolerances = st.sampled_from([None, 0.0, 2.0, 5.0])


def write(path, *items, system=1):
    """Write a tlog of (seconds after the start, message)."""
    times, messages = zip(*items, strict=True)
    packets = encoded(messages, system=system)
    path.write_bytes(
        b"".join(
            (START + round(time * 1e6)).to_bytes(8, "big") + raw
            for time, raw in zip(times, packets, strict=True)
        )
    )
    return mavstack.open_log(path, "common", timestamped=True)


def recorded(path, left, right):
    items = [(time, common.Attitude(time_boot_ms=number)) for number, time in enumerate(left)]
    items += [(time, common.VfrHud(alt=number)) for number, time in enumerate(right)]
    return write(path, *items)


@pytest.fixture
def log(tmp_path):
    return write(
        tmp_path / "flight",
        (0, common.Attitude(roll=0)),
        (1, common.Attitude(roll=1)),
        (3, common.Attitude(roll=5)),
        (1.5, common.GpsRawInt(lat=471234567, fix_type=3)),
        (2.5, common.GpsRawInt(lat=471234569, fix_type=4)),
        (0.5, common.BatteryStatus(id=1, voltages=[3800, 3900, *[65535] * 8])),
        (0.5, common.ParamValue(param_id="RTL_ALT")),
    )


def test_resampling_at_a_rate(log):
    columns = align.resample(log, ["ATTITUDE.roll", "GPS_RAW_INT.fix_type"], rate=2)
    assert list(columns) == ["_time", "ATTITUDE.roll", "GPS_RAW_INT.fix_type"]
    np.testing.assert_allclose(columns["_time"] - START / 1e6, np.arange(7) / 2, atol=1e-6)
    assert columns["ATTITUDE.roll"].tolist() == [0, 0, 1, 1, 1, 1, 5]
    np.testing.assert_array_equal(columns["GPS_RAW_INT.fix_type"], [np.nan] * 3 + [3, 3, 4, 4])


def test_resampling_like_a_table(log):
    columns = align.resample(log, ["ATTITUDE.roll"], like="GPS_RAW_INT", method="linear")
    np.testing.assert_allclose(columns["ATTITUDE.roll"], [2, 4])
    near = align.resample(log, ["ATTITUDE.roll"], like="GPS_RAW_INT", method="nearest", tolerance=0.4)
    assert np.isnan(near["ATTITUDE.roll"]).all()


def test_instances_elements_units_and_texts(log):
    columns = align.resample(
        log, ["BATTERY_STATUS[1].voltages[1]", "GPS_RAW_INT.lat", "PARAM_VALUE.param_id"], rate=1, scaled=True
    )
    np.testing.assert_allclose(columns["BATTERY_STATUS[1].voltages[1]"], [3.9, 3.9, 3.9])
    np.testing.assert_allclose(columns["GPS_RAW_INT.lat"], [np.nan, 47.1234567, 47.1234569])
    assert columns["PARAM_VALUE.param_id"].tolist() == [b"RTL_ALT"] * 3


def test_joining_keeps_the_rows_of_the_first_table(log):
    rows = align.join(log, "ATTITUDE", "GPS_RAW_INT", "BATTERY_STATUS", tolerance=1.0)
    assert rows["ATTITUDE.roll"].tolist() == [0, 1, 5]
    np.testing.assert_array_equal(rows["GPS_RAW_INT.fix_type"], [np.nan, np.nan, 4])
    assert rows["BATTERY_STATUS.voltages"].shape == (3, 10)
    assert rows["BATTERY_STATUS.voltages"][1, 0] == 3800
    assert not any("._" in name for name in rows)


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({"columns": ["ATTITUDE.roll"]}, "either rate or like"),
        ({"columns": ["ATTITUDE.roll"], "rate": 1, "like": "ATTITUDE"}, "either rate or like"),
        ({"columns": ["ATTITUDE.roll"], "rate": 0}, "rate must be positive"),
        ({"columns": ["ATTITUDE.roll"], "rate": 1e12}, "gives .* rows for 3 s"),
        ({"columns": ["ATTITUDE.roll"], "rate": 1, "method": "cubic"}, "method must be one of"),
        ({"columns": ["ATTITUDE"], "rate": 1}, "named TABLE.field"),
        (
            {"columns": ["ATTITUDE.rol"], "rate": 1},
            "ATTITUDE has no field rol; did you mean roll",
        ),
        ({"columns": ["PARAM_VALUE.param_id"], "rate": 1, "method": "linear"}, "cannot be interpolated"),
    ],
)
def test_misuse_raises(log, arguments, error):
    with pytest.raises(InvalidArgumentError, match=error):
        align.resample(log, **arguments)


def test_other_misuse_raises(log):
    with pytest.raises(UnknownMessageError):
        align.resample(log, ["VFR_HUD.alt"], rate=1)
    with pytest.raises(InvalidArgumentError, match="direction must be one of"):
        align.join(log, "ATTITUDE", "GPS_RAW_INT", direction="up")


def test_vehicles_are_not_mixed(tmp_path, log):
    write(tmp_path / "other", (0.2, common.Attitude(roll=9)), system=2)
    path = tmp_path / "both"
    path.write_bytes((tmp_path / "flight").read_bytes() + (tmp_path / "other").read_bytes())
    both = mavstack.open_log(path)
    with pytest.raises(InvalidArgumentError, match="ATTITUDE has rows of systems 1, 2: choose one"):
        align.resample(both, ["ATTITUDE.roll"], rate=1)
    assert align.resample(both.select(system=2), ["ATTITUDE.roll"], rate=1)["ATTITUDE.roll"].tolist() == [9]


@settings(max_examples=30)
@given(moments, moments, st.sampled_from(["backward", "forward", "nearest"]), tolerances)
def test_joins_equal_those_of_pandas(tmp_path_factory, left, right, direction, tolerance):
    pd = pytest.importorskip("pandas")
    log = recorded(tmp_path_factory.getbasetemp() / "align", left, right)
    ours = align.join(log, "ATTITUDE", "VFR_HUD", direction=direction, tolerance=tolerance)
    frames = [
        pd.DataFrame({"time": np.array(times, float), name: range(len(times))}).sort_values(
            "time", kind="stable"
        )
        for name, times in (("left", left), ("right", right))
    ]
    theirs = pd.merge_asof(*frames, on="time", direction=direction, tolerance=tolerance)
    assert ours["ATTITUDE.time_boot_ms"].tolist() == theirs["left"].tolist()
    np.testing.assert_array_equal(ours["VFR_HUD.alt"], theirs["right"].to_numpy(float))


@settings(max_examples=30)
@given(moments, st.lists(st.integers(0, 40), min_size=1, max_size=12, unique=True))
def test_interpolation_equals_that_of_numpy(tmp_path_factory, left, right):
    log = recorded(tmp_path_factory.getbasetemp() / "align", left, right)
    ours = align.resample(log, ["VFR_HUD.alt"], like="ATTITUDE", method="linear")
    order = np.argsort(right)
    expected = np.interp(np.sort(left), np.array(right)[order], order, left=np.nan, right=np.nan)
    np.testing.assert_allclose(ours["VFR_HUD.alt"], expected, atol=1e-5)
