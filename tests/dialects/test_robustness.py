"""A definition file with any content is a usable dialect or raises one DialectError."""

import pickle

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mavstack.dialects import Dialect
from mavstack.errors import DialectError

NAMES = st.sampled_from(
    ["A", "E_A", "a", "class", "None", "_x_", "__init__", "__E__x", "name", "mro", "definition", "9", "é", ""]
)
VALUES = st.sampled_from(
    ["0", "1", "-1", "3", "0x80000000", "2**63", "2**64", "x", "99999999999999999999", " 5 "]
)
TYPES = st.sampled_from(
    ["uint8_t", "char[5]", "float", "double[3]", "uint64_t", "uint8_t[255]", "int8_t[0]", "x"]
)
REFERENCES = st.sampled_from(["", ' enum="E"', ' enum="_x_"', ' enum="F"'])


@st.composite
def definition_files(draw):
    def entries():
        found = draw(st.lists(st.tuples(NAMES, VALUES), max_size=4))
        return "".join(f'<entry name="{name}" value="{value}"/>' for name, value in found)

    def fields():
        found = draw(st.lists(st.tuples(NAMES, TYPES, REFERENCES), max_size=5))
        return "".join(f'<field type="{kind}" name="{name}"{enum}/>' for name, kind, enum in found)

    mask = st.sampled_from(["", ' bitmask="true"'])
    enum_names = draw(st.lists(st.sampled_from(["E", "F", "_x_", "__E__"]), max_size=3))
    enums = "".join(f'<enum name="{name}"{draw(mask)}>{entries()}</enum>' for name in enum_names)
    ids = draw(st.lists(st.integers(0, 3), max_size=3))
    messages = "".join(f'<message id="{number}" name="{draw(NAMES)}">{fields()}</message>' for number in ids)
    return f"<mavlink><enums>{enums}</enums><messages>{messages}</messages></mavlink>".encode()


def use(dialect):
    for enum in dialect.enums.values():
        for member in enum:
            assert pickle.loads(pickle.dumps(member)) is member
            assert member.official_name
    for message_class in dialect:
        message = message_class.from_payload(bytes(range(1, 1 + message_class.definition.length)))
        assert message_class.from_payload(message.to_payload()) == message
        assert repr(message)
        message.to_json(enums="name")
    assert dialect.core_dialect is not None


def load_and_use(path):
    try:
        dialect = Dialect.from_xml(path)
    except DialectError as error:
        text = str(error)
    else:
        use(dialect)
        return
    assert text.startswith(str(path))


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return tmp_path_factory.mktemp("xml") / "x.xml"


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(definition_files())
def test_composed_files(path, data):
    path.write_bytes(data)
    load_and_use(path)


VALID = b"""<mavlink><version>3</version>
<enums><enum name="E" bitmask="true"><entry name="E_A" value="0x1"/></enum></enums>
<messages><message id="1" name="M"><description>d</description>
<field type="uint8_t" name="a" enum="E">t</field>
<extensions/><field type="char[9]" name="b"/></message></messages></mavlink>"""


@settings(max_examples=300, deadline=None)
@given(st.integers(0, len(VALID) - 1), st.binary(max_size=3), st.integers(0, 3))
def test_damaged_files(path, position, inserted, removed):
    path.write_bytes(VALID[:position] + inserted + VALID[position + removed :])
    load_and_use(path)
