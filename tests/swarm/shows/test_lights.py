"""Light programs of colours."""

from __future__ import annotations

from mavstack.swarm.shows.lights import light_program


def test_equal_colours_are_one_command():
    colours = [(0.0, (255, 0, 0)), (1.0, (255, 0, 0)), (2.0, (0, 300, -1)), (5.0, (0, 300, -1))]
    assert light_program(colours) == bytes((4, 255, 0, 0, 100, 4, 0, 255, 0, 0x96, 1, 0))


def test_no_colours_are_no_program():
    assert light_program([]) == b""
