"""A dialect with names and texts that break libraries whose generator is careless.

Its names are words that languages reserve, and those of the runtimes and of the variables in their templates;
its values are at their limits; its texts hold the marks of comments, strings and escapes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import escape, quoteattr

if TYPE_CHECKING:
    from collections.abc import Iterable

#: Marks of all languages; a text that leaves its comment or string is code that no compiler accepts.
HOSTILE: Final = (
    "*/ leaves; /* --]] leaves() --[[ ]] \"\"\" ''' `leaves` ${leaves} #{leaves} %s {0} \\(leaves) "
    "\\u000a leaves {@link X} @Deprecated <b> & &amp; </summary> #endif // ??/ \u202e\ufeff\u2028\u0085 "
    '"leaves" \n leaves \\ '
)
#: Parameters, variables and members in the templates, types of the languages, and reserved words.
_FIELDS_TEXT: Final = """
b o m i c id at buf msg self this cls map get new data view fields function value values payload reader
writer field index name info _buf _status chan msgbuf system_id component_id status _view _start _end read
int class type func end is in fn match loop let var lambda constructor string bytes uint8_t bool
"""
#: Members of classes, structs and modules, and names that differ little.
_MEMBERS_TEXT: Final = """
ID NAME INFO STRUCT LENGTH MSG_ID CRC_EXTRA Info wire Wire dialect std mavlink field_type field_info
message_info message hash hash_value encode_payload to_payload from_payload to_yaml get_name serialize
to_string toString to_object _ a_b aB a__b _1 String field_value words Words NULL linux None nil null true
object option definition decode encode equals
"""
#: Types of the runtimes and of languages, and words that are reserved.
_MESSAGES_TEXT: Final = """
MESSAGE STATUS SYSTEM FIELD_INFO MESSAGE_INFO MSG CHAN INT SELF OPTION DEFAULT PACKET TEXT WIRE DECODE
STRUCT CLASS TYPE ENUM MAP ERROR CRC UTF8 BOOL
"""
_WORDS_TEXT: Final = """
class loop end name self values value description rawValue hash of in insert constructor default None NULL
true
"""
FIELDS: Final = _FIELDS_TEXT.split()
MEMBERS: Final = _MEMBERS_TEXT.split()
MESSAGES: Final = _MESSAGES_TEXT.split()
_WORDS: Final = _WORDS_TEXT.split()


def _fields(names: Iterable[str], kinds: tuple[str, ...], attributes: str = "") -> str:
    return "".join(
        f'<field type="{kinds[index % len(kinds)]}" name="{name}"{attributes}>{name}</field>'
        for index, name in enumerate(names)
    )


def _described(*texts: str) -> str:
    return "".join(
        f'<field type="uint8_t" name="d{index}">{text}</field>' for index, text in enumerate(texts)
    )


_TEXT: Final = escape(HOSTILE)
_UNIT: Final = quoteattr(HOSTILE)
_DOC: Final = f"<description>{_TEXT}</description>"
_ENUMS: Final = f"""
    <enum name="LIMITS"><description>"Text" with \\u0041 */ &lt;b&gt; {{@link X}} // and 'more'.</description>
      <entry name="LIMITS_NEW" value="0"/><entry name="LIMITS_CLASS" value="2147483648"/>
      <entry name="LIMITS_2D" value="18446744073709551615"/><entry name="LIMITS_VALUE" value="7"/></enum>
    <enum name="STRING" bitmask="true"><entry name="STRING_A" value="1"/>
      <entry name="STRING_B" value="8"/></enum>
    <enum name="PARSER"><entry name="PARSER_RED" value="0"/><entry name="PARSER_BLUE" value="300"/></enum>
    <enum name="FROM"><entry name="FROM_HERE" value="-1"/><entry name="FROM_THERE" value="1"/></enum>
    <enum name="LOWEST"><entry name="LOWEST_ONE" value="-9223372036854775808"/>
      <entry name="LOWEST_TWO" value="5"/></enum>
    <enum name="int"><entry name="int" value="1"/><entry name="double" value="2"/></enum>
    <enum name="msg"><entry name="NULL" value="3"/><entry name="msg" value="4"/></enum>
    <enum name="FLAGS" bitmask="true">{_DOC}<entry name="FLAGS_contains" value="1"/>
      <entry name="FLAGS_bits" value="2"/><entry name="FLAGS_EMPTY" value="0"/></enum>
    <enum name="MAV_CMD"><entry name="MAV_CMD_LEAVE" value="1">{_DOC}
      <param index="1" label={_UNIT} units={_UNIT}>{_TEXT}</param></entry></enum>
"""


def _definition() -> str:
    text, unit, doc = _TEXT, _UNIT, _DOC
    words = "".join(f'<entry name="WORDS_{word}" value="{n}">{doc}</entry>' for n, word in enumerate(_WORDS))
    hostile = f'units={unit} invalid={unit} print_format={unit} enum="WORDS"'
    arrays = ("uint8_t[2]", "uint16_t[2]", "char[2]")
    kinds = ("uint8_t", "float", "uint16_t")
    others = "".join(
        f'<message id="{10 + number}" name="{name}">{doc}'
        '<field type="uint8_t" name="x" enum="FROM">x</field></message>'
        for number, name in enumerate(MESSAGES)
    )
    enums = f'{_ENUMS}<enum name="WORDS">{doc}{words}</enum>'
    return f"""<mavlink>
  <enums>{enums}</enums>
  <messages>
    <message id="1" name="OBJECT"><description>Fields with the names of "keywords" \\u000a.</description>
      {_fields(FIELDS, kinds)}<field type="uint8_t" name="kind" enum="PARSER">a*/b</field>
      <field type="uint16_t" name="unit" units="m/s" enum="STRING">x</field></message>
    <message id="2" name="PARSER"><description/><field type="uint8_t" name="parser">x</field>
      <field type="char" name="c">x</field><field type="uint64_t" name="id" enum="LIMITS">x</field>
      <field type="int8_t" name="message_id">x</field><field type="int64_t[2]" name="info">x</field>
      <field type="double[3]" name="value">x</field><field type="int16_t" name="get">x</field></message>
    <message id="3" name="STRING"><description>x</description><field type="uint8_t" name="i">x</field>
      <field type="uint8_t" name="string" enum="STRING">x</field>
      <field type="uint8_t" name="field">x</field></message>
    <message id="4" name="LINUX_TEST"><description>x</description>
      <field type="uint8_t" name="z">x</field></message>
    <message id="5" name="HOSTILE"><deprecated since={unit} replaced_by={unit}>{text}</deprecated>{doc}
      <field type="uint8_t" name="x" {hostile}>{text}</field>
      <field type="char[5]" name="text" units={unit}>{text}</field>
      {_described("- a list", "# Heading", "1. first", "[x]: http://leaves", "Deprecated: no", "go:leaves")}
      <extensions/><field type="uint8_t[3]" name="y" {hostile}>{text}</field></message>
    <message id="6" name="MEMBERS">{doc}{_fields(MEMBERS, kinds)}</message>
    <message id="7" name="ARRAYS">{doc}{_fields(FIELDS[:20], arrays)}</message>
    <message id="8" name="PAYLOAD">{doc}<field type="uint8_t[9]" name="payload">x</field></message>
    <message id="9" name="ENUMS">{doc}<field type="uint8_t" name="int" enum="int">x</field>
      <field type="int64_t" name="lowest" enum="LOWEST">x</field>
      <field type="uint8_t" name="msg" enum="msg">x</field>
      <field type="uint8_t[3]" name="flags" enum="FLAGS">x</field>
      <field type="uint32_t" name="limits">x</field>
      <field type="uint64_t" name="more" enum="LIMITS">x</field></message>
    {others}
  </messages>
</mavlink>
"""


AWKWARD: Final = _definition()
