from __future__ import annotations

import builtins
import sys

import pytest

from mavstack.cli.watch.live_table import render
from mavstack.cli.watch.observer import Observer
from mavstack.cli.watch.snapshot import take_snapshot
from mavstack.dialects import Dialect, common
from mavstack.errors import MissingExtraError
from mavstack.wire import Encoder
from tests.cli.conftest import flight, setup_signing


def observed(channels: int = 1, systems: int = 1) -> Observer:
    observer = Observer(Dialect.load("all"))
    for channel in range(channels):
        observer.open(f"udpin 127.0.0.1:{channel}")
        for index in range(3):
            observer.receive(f"udpin 127.0.0.1:{channel}", b"".join(flight(10)), float(index))
    for system in range(2, systems + 1):
        observer.receive("udpin 127.0.0.1:0", Encoder(system, 1).encode(common.Heartbeat(type=2)), 2.0)
    return observer


def lines(observer: Observer, width: int, height: int, sort: str = "name", note: str = "") -> list[str]:
    picture = take_snapshot(observer, "udpin://0.0.0.0:14550", 2.0, 2.0, note)
    return [line.plain for line in render(picture, width, height, sort)]


@pytest.mark.parametrize(("width", "height"), [(80, 24), (120, 40), (40, 10), (20, 5), (300, 100)])
@pytest.mark.parametrize(("channels", "systems"), [(1, 1), (3, 2), (20, 60)])
def test_lines_fit_the_terminal(width, height, channels, systems):
    drawn = lines(observed(channels, systems), width, height)
    assert len(drawn) <= height
    assert max(map(len, drawn)) <= width


def test_contents():
    text = "\n".join(lines(observed(), 120, 40, note="no connection"))
    for word in (
        "udpin://0.0.0.0:14550",
        "1/1",
        "quadrotor",
        "ArduPilot",
        "ARMED",
        "LOITER",
        "no connection",
    ):
        assert word in text
    assert "roll 28.6°" in text
    assert "SOURCE" in text


def test_a_name_that_is_cut_off_ends_with_an_ellipsis():
    observer = observed()
    data = Encoder(1, 1).encode(common.GimbalDeviceAttitudeStatus())
    observer.receive("udpin 127.0.0.1:0", data, 2.0)
    assert " GIMBAL_DEVICE_ATTITUDE_STAT… " in "\n".join(lines(observer, 120, 40))


def test_hidden_rows_are_counted():
    observer = observed()
    for name in Dialect.load("common").names[:60]:
        message = Dialect.load("common")[name]()
        observer.receive("udpin 127.0.0.1:0", Encoder(1, 1).encode(message), 2.0)
    drawn = lines(observer, 80, 24)
    assert "more: --sort rate" in drawn[-1]


@pytest.mark.parametrize(
    ("sort", "first"), [("name", "ATTITUDE"), ("rate", "ATTITUDE"), ("count", "ATTITUDE")]
)
def test_order(sort, first):
    drawn = lines(observed(), 80, 24, sort)
    head = next(index for index, line in enumerate(drawn) if "MESSAGE" in line)
    assert first in drawn[head + 1]


def test_several_channels_have_a_line_each():
    assert sum("udpin 127" in line for line in lines(observed(3), 120, 40)) == 3
    assert sum("udpin 127" in line for line in lines(observed(1), 120, 40)) == 0


def test_no_key_is_shown():
    observer = observed()
    observer.receive("udpin 127.0.0.1:0", setup_signing(), 2.0)
    text = "\n".join(lines(observer, 400, 40))
    assert "secret_key (hidden)" in text
    assert "64 65 66" not in text
    assert "100 101" not in text


def test_empty_observer():
    assert lines(Observer(Dialect.load("all")), 80, 24)


def test_without_rich_the_error_names_the_extra_to_install(monkeypatch):
    real = builtins.__import__

    def without_rich(name, *rest):
        if name.startswith("rich"):
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.delitem(sys.modules, "mavstack.cli.watch.live_table")
    monkeypatch.delitem(sys.modules, "mavstack.cli.common.live_display")
    monkeypatch.setattr(builtins, "__import__", without_rich)
    with pytest.raises(MissingExtraError, match=r"pip install 'mavstack\[cli\]'"):
        import mavstack.cli.watch.live_table  # noqa: F401
