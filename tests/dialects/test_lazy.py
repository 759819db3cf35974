"""Dialect modules: their attributes, and what importing them must not load."""

import importlib
import subprocess
import sys

import pytest

from mavstack.dialects import Dialect, common
from mavstack.dialects.tables import official_names


def modules_after(code):
    program = f"import sys\n{code}\nprint(' '.join(sys.modules))"
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return set(result.stdout.split())


HEAVY = {
    "asyncio",
    "numpy",
    "xml",
    "xml.parsers.expat",
    "rich",
    "dataclasses",
    "inspect",
    "socket",
    "pathlib",
    "ssl",
}


@pytest.mark.parametrize(
    "code",
    [
        "import mavstack",
        "import mavstack.dialects",
        "from mavstack.dialects import common",
        "from mavstack.dialects import ardupilotmega as a; a.Attitude(roll=0.1)",
        "from mavstack.dialects import common as c; repr(c.Heartbeat(type=1)); c.core_dialect; c.MavCmd",
    ],
)
def test_imports_are_lazy(code):
    assert modules_after(code) & HEAVY == set()


def test_a_dialect_imports_no_other_dialects_module():
    loaded = modules_after("from mavstack.dialects import ardupilotmega as a; a.Attitude")
    assert "mavstack.dialects.common" not in loaded
    assert "mavstack.dialects.model" not in loaded


@pytest.mark.parametrize("name", official_names())
def test_every_dialect_is_a_module(name):
    module = importlib.import_module(f"mavstack.dialects.{name.lower()}")
    dialect = Dialect.load(name)
    assert module.dialect is dialect
    assert module.core_dialect is dialect.core_dialect
    assert len(module.__all__) == len(dialect) + len(dialect.enums)
    for attribute in dir(module):
        value = getattr(module, attribute)
        assert value is getattr(module, attribute)
    for message_class in dialect:
        assert getattr(module, message_class.__name__) is message_class
    for enum in dialect.enums.values():
        assert getattr(module, enum.__name__) is enum


def test_an_unknown_name_raises_attribute_error():
    with pytest.raises(AttributeError, match="common has no message or enum class 'Atitude'"):
        _ = common.Atitude
    with pytest.raises(ImportError):
        exec("from mavstack.dialects.common import Atitude")


def test_star_import():
    names = {}
    exec("from mavstack.dialects.minimal import *", names)
    assert {"Heartbeat", "MavType"} <= names.keys()


def test_a_message_and_an_enum_of_one_name_both_have_a_class(tmp_path):
    path = tmp_path / "own.xml"
    path.write_text(
        '<mavlink><enums><enum name="MODE"><entry name="MODE_A" value="1"/></enum></enums><messages>'
        '<message id="9" name="MODE"><field type="uint8_t" name="a" enum="MODE"/></message>'
        "</messages></mavlink>"
    )
    dialect = Dialect.from_xml(path)
    assert (dialect.messages_by_class, dialect.enums_by_class) == ({"Mode": "MODE"}, {"ModeEnum": "MODE"})
    assert (dialect["MODE"].__name__, dialect.enums["MODE"].__name__) == ("Mode", "ModeEnum")
    assert dialect["MODE"](a=1).a is dialect.enums["MODE"].A
