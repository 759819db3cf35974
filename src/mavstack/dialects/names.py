"""Conversion of definition names to Python names: classes, enum members and attributes.

`ATTITUDE` becomes the class `Attitude`, `MAV_CMD` becomes `MavCmd`. Enum members lose the words with which
all entries begin (`MAV_CMD_NAV_TAKEOFF` becomes `NAV_TAKEOFF`; a single entry loses the words that it shares
with its enum), and a name that would begin with a digit gets a leading `_`. The prefix is determined from the
file that first defines the enum, so that other files never change the name of a member; an added entry that
does not begin with the prefix, or would have the name of another member, keeps its full name. A Python
keyword, or a name that the class itself uses, gets a trailing `_`.
"""

from __future__ import annotations

from keyword import iskeyword
from os.path import commonprefix

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


def class_name(official: str) -> str:
    """Return the class name of a message or enum."""
    if official.isupper():
        name = official.title().replace("_", "")
    else:
        words = official.split("_")
        name = "".join(word.title() if word.isupper() else word[:1].upper() + word[1:] for word in words)
    return to_identifier(name or "_") if not name[:1].isalpha() or iskeyword(name) else name


def to_identifier(name: str, taken: Iterable[str] = ()) -> str:
    """Return a valid attribute name that is not in `taken`, changed as little as possible."""
    name = f"_{name}" if name[:1].isdigit() else name
    while iskeyword(name) or name in taken or (name.startswith("_") and name.endswith("_")):
        name += "_" if not name.startswith("_") else "0"
    return name


def shared_prefix(enum: str, entries: Sequence[str]) -> str:
    """Return the words with which all entries begin, including the last `_`; never a complete entry."""
    if not entries:
        return ""
    names = entries if len(entries) > 1 else (*entries, f"{enum}_")
    common = commonprefix((min(names), max(names)))  # noqa: RUF071 (texts, not paths)
    prefix = common[: common.rfind("_") + 1]
    return "" if prefix in entries else prefix


def member_names(
    enum: str, origin: Sequence[str], added: Sequence[str], taken: Iterable[str]
) -> dict[str, str]:
    """Return the member names by entry name; `taken` are names that the enum class uses itself."""
    prefix = shared_prefix(enum, origin)
    taken = frozenset(taken)
    names: dict[str, str] = {}
    used: set[str] = set()
    for entry in (*origin, *added):
        name = to_identifier(entry.removeprefix(prefix), taken)
        if name in used:
            name = to_identifier(entry, taken | used)
        used.add(name)
        names[entry] = name
    return names
