"""Includes: where they are searched, their order, and contradictions between files."""

import pytest

from mavstack.dialects import Dialect, common
from mavstack.dialects.checks import check_file
from mavstack.dialects.includes import collect, included_first
from mavstack.errors import DialectError


def message(name, number):
    return f'<message id="{number}" name="{name}"><field type="uint8_t" name="a"/></message>'


def enum(*entries, name="E"):
    inside = "".join(f'\n<entry name="{entry}" value="{value}"/>' for entry, value in entries)
    return f'<enums><enum name="{name}">{inside}</enum></enums>'


@pytest.fixture
def write(tmp_path):
    def write(name, *includes, messages="", enums=""):
        path = tmp_path / f"{name}.xml"
        path.parent.mkdir(parents=True, exist_ok=True)
        lines = "".join(f"\n<include>{include}</include>" for include in includes)
        path.write_text(f"<mavlink>{lines}\n{enums}\n<messages>\n{messages}\n</messages></mavlink>")
        return path

    return write


def fails(path):
    with pytest.raises(DialectError) as caught:
        Dialect.from_xml(path)
    return caught.value


def test_included_files_come_first_and_once(write):
    write("base", messages=message("BASE", 1))
    write("left", "base.xml", messages=message("LEFT", 2))
    write("right", "base.xml", messages=message("RIGHT", 3))
    top = write("top", "left.xml", "right.xml", "base.xml", messages=message("TOP", 4))
    assert [item.definition.name for item in included_first(collect(str(top)))] == [
        "base",
        "left",
        "right",
        "top",
    ]
    assert Dialect.from_xml(top).names == ("BASE", "LEFT", "RIGHT", "TOP")


def test_includes_are_relative_to_the_including_file(write):
    write("deep/er/inner", messages=message("INNER", 1))
    write("deep/outer", "er/inner.xml", messages=message("OUTER", 2))
    assert len(Dialect.from_xml(write("top", "deep/outer.xml"))) == 2


def test_an_include_cycle_raises_with_the_chain_the_file_and_the_line(write):
    write("b", "c.xml")
    c = write("c", "a.xml")
    error = fails(write("a", "b.xml"))
    assert "a.xml -> b.xml -> c.xml -> a.xml" in error.problem
    assert (error.path, error.line) == (str(c), 2)


def test_a_file_that_includes_itself_is_a_cycle(write):
    assert "a.xml -> a.xml" in fails(write("a", "a.xml")).problem


def test_a_missing_include_raises_with_its_line(write):
    error = fails(write("a", "gone.xml"))
    assert "gone.xml" in error.problem
    assert error.line == 2


def test_an_error_in_an_included_file_names_that_file(write):
    inner = write("inner", messages='<message id="1" name="X"/>')
    assert fails(write("top", "inner.xml")).path == str(inner)


def test_depth_and_number_of_includes_are_limited(write):
    for index in range(30):
        write(f"f{index}", f"f{index + 1}.xml")
    write("f30")
    assert "nested deeper" in fails(write("top", "f0.xml")).problem
    for index in range(120):
        write(f"g{index}")
    assert "files are included" in fails(write("wide", *(f"g{index}.xml" for index in range(120)))).problem


def test_repeated_includes_take_no_exponential_time(write):
    for level in range(15):
        below = [f"l{level + 1}_{index}.xml" for index in range(5)]
        for index in range(5):
            write(f"l{level}_{index}", *below)
    for index in range(5):
        write(f"l15_{index}", messages=message(f"M{index}", index))
    assert len(Dialect.from_xml(write("top", "l0_0.xml"))) == 5


def test_official_files_need_no_copy(write):
    dialect = Dialect.from_xml(write("mine", "common.xml", messages=message("MINE", 20000)))
    assert dialect["ATTITUDE"] is common.Attitude
    assert dialect["MINE"](a=3).a == 3
    assert len(dialect) == len(common.dialect) + 1


def test_a_file_in_the_folder_replaces_an_official_one(write):
    write("common", messages=message("OWN", 7))
    assert Dialect.from_xml(write("mine", "common.xml")).names == ("OWN",)


@pytest.mark.parametrize(
    ("first", "second", "problem"),
    [
        (message("A", 1), message("B", 1), "message id 1 is already used by A of first"),
        (message("A", 1), message("A", 2), "message A is already defined in first"),
        (message("A", 1), message("A", 1), "message id 1"),
    ],
)
def test_two_files_may_not_define_the_same_message(write, first, second, problem):
    write("first", messages=first)
    error = fails(write("second", "first.xml", messages=second))
    assert problem in error.problem
    assert error.path.endswith("second.xml")
    assert error.line == 5


def test_enums_are_merged(write):
    write("first", enums=enum(("E_A", 1), ("E_B", 2)))
    top = write("second", "first.xml", enums=enum(("E_C", 3), ("E_B", 2)))
    dialect = Dialect.from_xml(top)
    assert [(member.name, member.value) for member in dialect.enums["E"]] == [("A", 1), ("B", 2), ("C", 3)]
    assert [entry.name for entry in dialect.enum_definition("E").entries] == ["E_A", "E_B", "E_C"]


@pytest.mark.parametrize(
    ("entries", "problem"),
    [([("E_A", 5)], "E_A of enum E is 1"), ([("E_C", 1)], "has the value 1 twice: E_A and E_C")],
)
def test_a_file_may_not_contradict_an_enum(write, entries, problem):
    write("first", enums=enum(("E_A", 1)))
    error = fails(write("second", "first.xml", enums=enum(*entries)))
    assert problem in error.problem
    assert (error.path.endswith("second.xml"), error.line) == (True, 4)


def test_unnumbered_entries_follow_those_of_the_included_files(write):
    write("first", enums=enum(("E_A", 1), ("E_B", 7)))
    added = '<enums><enum name="E"><entry name="E_C"/><entry name="E_D"/></enum></enums>'
    dialect = Dialect.from_xml(write("second", "first.xml", enums=added))
    assert [entry.value for entry in dialect.enum_definition("E").entries] == [1, 7, 8, 9]
    assert [(member.name, member.value) for member in dialect.enums["E"]][2:] == [("C", 8), ("D", 9)]


def test_an_enum_is_a_bitmask_if_it_is_one_in_any_file(write):
    write("first", enums=enum(("E_A", 1)).replace('name="E"', 'name="E" bitmask="true"', 1))
    assert Dialect.from_xml(write("second", "first.xml", enums=enum(("E_B", 2)))).enums["E"](3).name == "A|B"


def test_a_field_may_not_refer_to_an_undefined_enum(write):
    field = '<message id="1" name="M">\n<field type="uint8_t" name="a" enum="NOWHERE"/></message>'
    error = fails(write("a", messages=field))
    assert "M.a refers to the undefined enum NOWHERE" in error.problem
    assert error.line == 5


@pytest.mark.parametrize("place", ["top", "sibling"])
def test_an_enum_of_a_file_that_is_not_included_is_taken_with_a_warning(write, place):
    """As mavgen does, which reads all files as one."""
    field = '<message id="1" name="M"><field type="int8_t" name="a" enum="E"/></message>'
    base = write("base", messages=field)
    write("sibling", enums=enum(("E_A", -1)) if place == "sibling" else "")
    top = write("top", "sibling.xml", "base.xml", enums=enum(("E_A", -1)) if place == "top" else "")
    dialect = Dialect.from_xml(top)
    assert dialect["M"](a=-1).a is dialect.enums["E"].A
    assert dialect["M"](a=5).a == 5
    assert [item.name for item in dialect.definition.enums] == ["E"]
    (problem,) = [each for each in check_file(str(top)) if "E of a file" in each.text]
    assert (problem.severity, problem.path, problem.line) == ("warning", str(base), 4)
    assert "M.a uses the enum E of a file that is not included here" in problem.text
    assert "refers to the undefined enum E" in fails(base).problem


def test_an_enum_that_several_files_extend_is_complete_in_each_that_uses_it(write):
    field = '<message id="{0}" name="M{0}"><field type="uint8_t" name="a" enum="{1}"/></message>'
    write("base", messages=field.format(20001, "MAV_STATE"))
    write("adds", "minimal.xml", enums=enum(("MAV_STATE_X", 100), name="MAV_STATE"))
    write("other", messages=field.format(20002, "MAV_STATE"))
    own = '<enums><enum name="MAV_STATE"><entry name="MAV_STATE_Y"/></enum></enums>'
    top = write(
        "top", "base.xml", "adds.xml", "other.xml", enums=own, messages=field.format(20003, "MAV_STATE")
    )
    dialect = Dialect.from_xml(top)
    for name in ("M20001", "M20002", "M20003"):
        assert dialect[name](a=100).a.name == "X"
        assert dialect[name](a=101).a.name == "Y"
        assert dialect[name](a=4).a.name == "ACTIVE"
    assert dialect["HEARTBEAT"](system_status=4).system_status.name == "ACTIVE"


def test_the_check_loads_each_class(write, monkeypatch):
    top = write("top", messages=message("M", 1))
    monkeypatch.setattr(Dialect, "_make_class", lambda self, number: 1 / 0)
    (problem,) = check_file(str(top))
    assert str(problem) == f"{top}: error: it cannot be loaded: ZeroDivisionError: division by zero"


def test_includes_in_different_orders_give_classes(write):
    write(
        "base",
        enums=enum(("E_A", 1)),
        messages='<message id="1" name="M"><field type="uint8_t" name="e" enum="E"/></message>',
    )
    write("a", "base.xml", enums=enum(("E_B", 2)))
    write("b", "base.xml", enums=enum(("E_C", 3)))
    write("x", "a.xml", "b.xml", enums=enum(("E_D", 4)))
    write("y", "b.xml", "a.xml", enums=enum(("E_F", 5)))
    dialect = Dialect.from_xml(write("z", "x.xml", "y.xml", enums=enum(("E_G", 6))))
    assert dialect["M"](e=6).e.name == "G"
