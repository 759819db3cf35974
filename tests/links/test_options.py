from __future__ import annotations

import pytest

from mavstack.errors import LinkURLError
from mavstack.links import open_link
from mavstack.links.options import Options
from mavstack.links.url import LinkURL, parse_url


def options(query: str) -> Options:
    return Options(parse_url(f"udpin://0.0.0.0:1?{query}"))


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("200ms", 0.2),
        ("1.5", 1.5),
        ("2s", 2),
        ("5us", 5e-6),
        ("1min", 60),
        (".5", 0.5),
        ("1e-3", 0.001),
        ("0", 0),
    ],
)
def test_times(text, seconds):
    assert options(f"t={text}").seconds("t", 9) == pytest.approx(seconds)


@pytest.mark.parametrize(("text", "size"), [("5760", 5760), ("64k", 65536), ("4M", 4 << 20), ("0.5k", 512)])
def test_sizes(text, size):
    assert options(f"s={text}").size("s", 9) == size


@pytest.mark.parametrize(("text", "fraction"), [("0.1", 0.1), ("10%25", 0.1), ("1", 1), ("0", 0)])
def test_fractions(text, fraction):
    assert options(f"f={text}").fraction("f", 0.5) == pytest.approx(fraction)


def test_flags_choices_and_integers():
    parsed = options("a=YES&b=off&n=7&w=rtscts")
    assert parsed.flag("a", default=False)
    assert not parsed.flag("b", default=True)
    assert parsed.integer("n", 1) == 7
    assert parsed.choice("w", ("none", "rtscts")) == "rtscts"
    parsed.refuse_unknown()


def test_defaults():
    parsed = options("")
    assert parsed.flag("a", default=True)
    assert (parsed.integer("n", 3), parsed.seconds("t", 1.5), parsed.size("s", 7), parsed.text("x")) == (
        3,
        1.5,
        7,
        "",
    )
    assert parsed.choice("w", ("none", "rtscts")) == "none"


@pytest.mark.parametrize(
    ("query", "read", "expected"),
    [
        ("x=maybe", lambda o: o.flag("x", default=True), "x=maybe must be yes or no"),
        ("x=fast", lambda o: o.seconds("x", 1), "a time such as 200ms"),
        ("x=-1", lambda o: o.seconds("x", 1), "a time such as 200ms"),
        ("x=5kg", lambda o: o.size("x", 1), "a number of bytes"),
        (f"x={10**400}", lambda o: o.size("x", 1), "a number of bytes"),
        ("x=1.5", lambda o: o.fraction("x", 1), "between 0 and 1"),
        ("x=0", lambda o: o.integer("x", 1), "an integer of at least 1"),
        ("x=1.5", lambda o: o.integer("x", 1), "an integer of"),
        ("x=up", lambda o: o.choice("x", ("in", "out")), "one of in, out"),
    ],
)
def test_malformed_values_raise(query, read, expected):
    with pytest.raises(LinkURLError, match=expected):
        read(options(query))


def test_an_unknown_option_raises_with_a_suggestion():
    parsed = options("buad=57600&x=1")
    parsed.integer("baud", 1)
    with pytest.raises(LinkURLError, match=r"udpin has no option 'buad'; did you mean baud\?"):
        parsed.refuse_unknown()
    parsed = options("x=1")
    parsed.has("idle")
    with pytest.raises(LinkURLError, match="known options: idle"):
        parsed.refuse_unknown()


@pytest.mark.parametrize("more", ["", "&loss=0.1"])
def test_bandwidth_options_are_attributes_of_the_link(more):
    link = open_link(f"udpout://127.0.0.1:5?pace=5760&half_duplex=yes{more}")
    assert (link.pace, link.half_duplex) == (5760, True)
    assert open_link("udpout://127.0.0.1:5").pace == 0


def test_a_link_below_reads_options_of_its_own_url():
    above = LinkURL("msp", options={"baud": "9600", "speed": "3"})
    options = Options(above)
    below = options.of(LinkURL("serial", options={"baud": "115200", "speed": "3"}))
    assert below.integer("baud", 57600) == 115200
    with pytest.raises(LinkURLError, match="no option 'speed'"):
        options.refuse_unknown()
    assert options.integer("speed", 1) == 3
    options.refuse_unknown()
