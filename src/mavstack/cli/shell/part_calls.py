"""The command `call`: the calls of services that have no command of their own."""

from __future__ import annotations

from dataclasses import asdict, is_dataclass
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell.session import Command
from mavstack.node import RemoteComponent
from mavstack.node.part_calls import find_call, offered_calls

if TYPE_CHECKING:
    from mavstack.cli.shell.session import Session


async def call(session: Session, words: list[str]) -> None:
    """Run `call PART NAME ARGUMENTS`, or list the calls."""
    if not words:
        for each in offered_calls(RemoteComponent):
            session.print(f"{each.usage}: {each.summary}")
        return
    found = find_call(RemoteComponent, *words[:2]) if len(words) > 1 else None
    if found is None:
        raise UsageError(f"there is no call {' '.join(words[:2])!r}; `call` lists them")
    values = words[2:]
    if len(values) > len(found.arguments):
        raise UsageError(f"too many arguments; usage: call {found.usage}")
    result = await found.run(session.vehicle.component, dict(zip(found.arguments, values, strict=False)))
    lines = asdict(result).items() if is_dataclass(result) and not isinstance(result, type) else ()
    session.print(*(f"{name}: {value}" for name, value in lines) if lines else (str(result),))


COMMANDS: Final = (
    Command(
        "call", "[PART NAME [ARGUMENT …]]", "call a service of the vehicle that has no command", call,
        examples=("call", "call terrain check 47.3977 8.5456"),
        details="Without arguments it lists the calls. The results have the units of the API.",
    ),
)  # fmt: skip
