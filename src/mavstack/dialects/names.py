"""Official names to Python names: classes, enum members, attributes.

`ATTITUDE` is the class `Attitude`, `MAV_CMD` is `MavCmd`. An enum's members lose the words that they all
begin with (`MAV_CMD_NAV_TAKEOFF` is `NAV_TAKEOFF`; a lone member loses those that it shares with its enum),
and what would begin with a digit gets a `_`. The words to lose are found in the file that first defines the
enum, so that a member keeps its name whatever another file adds; an addition that does not begin with these
words, or would take another member's name, keeps its official name. A Python keyword, or a name that the
class needs for itself, gets a trailing `_`.
"""

from __future__ import annotations

from keyword import iskeyword

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


def class_name(official: str) -> str:
    """The Python class of a message or enum."""
    if official.isupper():
        name = official.title().replace("_", "")
    else:
        words = official.split("_")
        name = "".join(word.title() if word.isupper() else word[:1].upper() + word[1:] for word in words)
    return usable(name or "_") if not name[:1].isalpha() or iskeyword(name) else name


def usable(name: str, taken: Iterable[str] = ()) -> str:
    """The name, changed as little as needed to be an attribute that is not in `taken`."""
    name = f"_{name}" if name[:1].isdigit() else name
    while iskeyword(name) or name in taken or (name.startswith("_") and name.endswith("_")):
        name += "_" if not name.startswith("_") else "0"
    return name


def shared_words(enum: str, entries: Sequence[str]) -> str:
    """What all entries begin with, up to and with a `_`; never a whole entry."""
    split = [entry.split("_") for entry in entries]
    if len(split) == 1:
        split.append([*enum.split("_"), ""])
    count = 0
    for words in zip(*split, strict=False):
        if len(set(words)) > 1:
            break
        count += 1
    count = min([count, *(len(words) - 1 for words in split[: len(entries)])])
    prefix = "".join(f"{word}_" for word in split[0][:count]) if split else ""
    return "" if prefix in entries else prefix


def member_names(
    enum: str, origin: Sequence[str], added: Sequence[str], taken: Iterable[str]
) -> dict[str, str]:
    """Python member names by official names; `taken` are names that the enum class needs for itself."""
    prefix = shared_words(enum, origin)
    taken = frozenset(taken)
    names: dict[str, str] = {}
    used: set[str] = set()
    for entry in (*origin, *added):
        name = usable(entry.removeprefix(prefix), taken)
        if name in used:
            name = usable(entry, taken | used)
        used.add(name)
        names[entry] = name
    return names
