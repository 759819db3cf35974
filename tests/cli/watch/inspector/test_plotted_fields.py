"""The fields that are plotted together."""

from __future__ import annotations

import pytest

from mavstack.cli.watch.inspector.field_table import FieldName
from mavstack.cli.watch.inspector.plot import COLOURS
from mavstack.cli.watch.inspector.plotted_fields import MAX_PLOTTED
from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from tests.cli.watch.inspector.watched import Watched, stream

FIELDS = [FieldName(name) for name in ("roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed")]


def flying(**options) -> Watched:
    watched = Watched(**options)
    watched.fly()
    watched.inspector.select(stream())
    return watched


def test_several_fields_in_one_picture_with_colours_that_they_keep():
    inspector = flying().inspector
    for name in FIELDS[:3]:
        inspector.toggle_plot(name)
    assert [each.title for each in inspector.plot] == [f"1/1 ATTITUDE.{name}" for name in FIELDS[:3]]
    colours = inspector.plot_colours
    inspector.toggle_plot(FIELDS[0])
    assert inspector.plot_colours == {name: colours[name] for name in FIELDS[1:3]}
    inspector.toggle_plot(FIELDS[3])
    assert inspector.plot_colours[FIELDS[3]] == COLOURS[0]
    inspector.clear_plot()
    assert inspector.plot == []


def test_a_plot_holds_the_values_before_its_choice():
    inspector = flying().inspector
    inspector.toggle_plot(FIELDS[0])
    (series,) = inspector.plot
    assert len(series.points) == 10
    assert series.unit == "°"


def test_one_field_for_each_colour():
    watched = flying()
    watched.send(common.VfrHud())
    watched.inspector.update(watched.now)
    for name in FIELDS:
        watched.inspector.toggle_plot(name)
    watched.inspector.select(stream(74))
    with pytest.raises(InvalidArgumentError, match=f"at most {MAX_PLOTTED} fields"):
        watched.inspector.toggle_plot(FieldName("airspeed"))


def test_a_text_is_not_plotted():
    watched = Watched()
    watched.send(common.Statustext(text="hello"))
    watched.inspector.update(0.0)
    with pytest.raises(InvalidArgumentError, match=r"plotting STATUSTEXT\.text failed: it is not a number"):
        watched.inspector.toggle_plot(FieldName("text"))


def test_one_field_of_all_sources():
    watched = flying(links=1)
    watched.fly(system=2)
    watched.inspector.toggle_plot(FIELDS[0], everywhere=True)
    assert [each.title for each in watched.inspector.plot] == ["1/1 ATTITUDE.roll", "2/1 ATTITUDE.roll"]
    watched.inspector.toggle_plot(FIELDS[0], everywhere=True)
    assert watched.inspector.plot == []


def test_patterns_are_plotted_once_they_are_received():
    watched = flying(patterns="ATTITUDE.roll,VFR_HUD")
    assert list(watched.inspector.plot_colours) == [FIELDS[0]]
    watched.send(common.VfrHud())
    assert len(watched.inspector.plot) == MAX_PLOTTED
    watched.inspector.clear_plot()
    watched.fly(system=3)
    assert watched.inspector.plot == []
