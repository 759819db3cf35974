"""The calls of parts that user interfaces offer by themselves.

The row of a part says `offered=True`. Then the console (`call`) and the API of the station offer each public
coroutine of the part whose arguments are numbers, texts and flags; `timeout` is left to the interface. A new
service therefore needs no code in either of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from inspect import Parameter, getdoc, iscoroutinefunction, signature
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from mavstack.errors import InvalidArgumentError
from mavstack.node.parts import Part, parts_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

Plain: TypeAlias = bool | float | int | str

_TYPES: Final[Mapping[str, type[Plain]]] = MappingProxyType(
    {each.__name__: each for each in (bool, float, int, str)}
)
_FLAGS: Final[Mapping[str, bool]] = MappingProxyType({"true": True, "on": True, "false": False, "off": False})
_CONTEXT: Final = frozenset({"self", "timeout"})


@dataclass(frozen=True, slots=True)
class PartCall:
    """A call of a part.

    Attributes:
        part: The part.
        name: The name of the call.
        summary: The first line of its docstring.
        arguments: The type of each argument, by its name.
        required: The names of the arguments without a default.
    """

    part: Part[Any]
    name: str
    summary: str
    arguments: Mapping[str, type[Plain]]
    required: tuple[str, ...]

    @property
    def usage(self) -> str:
        """The words of the call with its arguments, such as `terrain check LATITUDE LONGITUDE`."""
        words = [name.upper() if name in self.required else f"[{name.upper()}]" for name in self.arguments]
        return " ".join((self.part.name, self.name, *words))

    async def run(self, owner: object, values: Mapping[str, object]) -> object:
        """Call the part of an object.

        Args:
            owner: The object that has the part, such as a `RemoteComponent`.
            values: The arguments by their names: values of their types, or texts.

        Returns:
            The result of the call.

        Raises:
            InvalidArgumentError: An argument is unknown, missing or not of its type.
            RemoteError: The call failed.
        """
        unknown = sorted(values.keys() - self.arguments.keys())
        missing = [name for name in self.required if name not in values]
        if unknown or missing:
            problem = f"{unknown[0]} is not an argument" if unknown else f"{missing[0]} is missing"
            raise InvalidArgumentError(f"{self.part.name} {self.name}: {problem}; usage: {self.usage}")
        given = {name: _converted(name, self.arguments[name], value) for name, value in values.items()}
        made = (
            self.part.__get__(owner, type(owner)) if self.part.made(owner) is None else self.part.made(owner)
        )
        return await getattr(made, self.name)(**given)


def offered_calls(owner: type) -> Iterator[PartCall]:
    """Yield the calls of the parts of a class that user interfaces offer."""
    for part in parts_of(owner):
        if part.offered:
            yield from _calls_of(part)


def find_call(owner: type, part: str, name: str) -> PartCall | None:
    """Return an offered call by the names of its part and itself; None if there is none."""
    return next((each for each in offered_calls(owner) if (each.part.name, each.name) == (part, name)), None)


def _calls_of(part: Part[Any]) -> Iterator[PartCall]:
    for name in dir(part.kind):
        function = getattr(part.kind, name)
        if name.startswith("_") or not iscoroutinefunction(function):
            continue
        parameters = [each for each in signature(function).parameters.values() if each.name not in _CONTEXT]
        types = {each.name: _type_of(each) for each in parameters}
        arguments = {key: kind for key, kind in types.items() if kind is not None}
        if len(arguments) == len(types):
            required = tuple(each.name for each in parameters if each.default is Parameter.empty)
            summary = (getdoc(function) or "").partition("\n")[0]
            yield PartCall(part, name, summary, MappingProxyType(arguments), required)


def _type_of(parameter: Parameter) -> type[Plain] | None:
    """Return the type of an argument that a user interface can ask for; None for any other argument."""
    if parameter.kind in (Parameter.VAR_POSITIONAL, Parameter.VAR_KEYWORD):
        return None
    return _TYPES.get(str(parameter.annotation).removesuffix(" | None"))


def _converted(name: str, kind: type[Plain], value: object) -> Plain:
    if isinstance(value, str) and kind is not str:
        try:
            return _FLAGS[value.lower()] if kind is bool else int(value, 0) if kind is int else float(value)
        except (KeyError, ValueError):
            raise InvalidArgumentError(f"{name} must be {_article(kind)}, got {value!r}") from None
    if kind is float and type(value) is int:
        return float(value)
    if type(value) is not kind:
        raise InvalidArgumentError(f"{name} must be {_article(kind)}, got {value!r}")
    return value


def _article(kind: type[Plain]) -> str:
    names = {bool: "true or false", float: "a number", int: "an integer", str: "a text"}
    return names[kind]
