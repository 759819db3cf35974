"""Setting up signing over the link, with confirmation and rollback (SETUP_SIGNING)."""

from mavstack.services.signing_setup.client import SetupSigning, SigningSetupClient
from mavstack.services.signing_setup.key_change import (
    KeyEvent,
    KeySettled,
    ListenForKey,
    UseNewKey,
    UseOldKey,
)
from mavstack.services.signing_setup.server import SigningRefused, SigningRequest, SigningSetupServer

__all__ = [
    "KeyEvent",
    "KeySettled",
    "ListenForKey",
    "SetupSigning",
    "SigningRefused",
    "SigningRequest",
    "SigningSetupClient",
    "SigningSetupServer",
    "UseNewKey",
    "UseOldKey",
]
