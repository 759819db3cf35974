"""The roles of the clients of a server link: `role=observe` for all, `roles=FILE` by their identity.

Each line of the file has a role and an identity, such as the subject of a certificate or the name of a key:

    administer  CN=ground-1,O=Fleet
    operate     CN=tablet-2,O=Fleet

A client that is not in the file observes. The role of `role=` (administer by default) is the highest that a
client can have, also by its ticket. See `mavstack.security.roles` for the packets that each role may send.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.bounded_file import read_file_bounded
from mavstack.errors import LinkError
from mavstack.security.observer_requests import ObserverRequests
from mavstack.security.roles import Role, RoleFilter

if TYPE_CHECKING:
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

WORDS: Final = tuple(role.word for role in reversed(Role))
_MAX_FILE: Final = 1 << 18


class RoleGate:
    """The roles of the clients of one link."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        self._limit = Role.from_word(options.choice("role", WORDS))
        self._requests = ObserverRequests()
        path = options.text("roles")
        self._roles = _read_roles(url, path) if path else None

    def role_of(self, identity: str, ticket: Role = Role.ADMINISTER) -> Role:
        """Return the role of a client by its identity and the role of its ticket."""
        listed = Role.ADMINISTER if self._roles is None else self._roles.get(identity, Role.OBSERVE)
        return min(self._limit, listed, ticket)

    def filter_of(self, identity: str, ticket: Role = Role.ADMINISTER) -> RoleFilter | None:
        """Return the filter for the packets of a client; None if it may send everything."""
        role = self.role_of(identity, ticket)
        return None if role is Role.ADMINISTER else RoleFilter(role, self._requests)


def _read_roles(url: LinkURL, path: str) -> dict[str, Role]:
    try:
        data = read_file_bounded(Path(path).expanduser(), _MAX_FILE + 1)
        text = data.decode()
    except (OSError, ValueError) as error:
        raise LinkError(f"cannot open {url.redacted}: cannot read the roles {path}: {error}") from None
    if len(data) > _MAX_FILE:
        raise LinkError(f"cannot open {url.redacted}: {path} is longer than {_MAX_FILE} bytes")
    roles: dict[str, Role] = {}
    for number, line in enumerate(text.splitlines(), 1):
        word, *rest = line.split(maxsplit=1) or [""]
        if not word or word.startswith("#"):
            continue
        identity = rest[0].strip() if rest else ""
        try:
            role = Role.from_word(word)
        except ValueError as error:
            raise LinkError(f"{path}, line {number}: {error}") from None
        if not identity or identity in roles:
            problem = "is named twice" if identity else "a role needs an identity behind it"
            raise LinkError(f"{path}, line {number}: {identity} {problem}".replace(":  ", ": "))
        roles[identity] = role
    return roles
