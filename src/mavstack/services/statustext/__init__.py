"""Status texts (STATUSTEXT), long ones in chunks."""

from mavstack.services.statustext.chunks import chunks_of
from mavstack.services.statustext.receiver import GAP, StatusText, StatustextReceiver
from mavstack.services.statustext.sender import StatustextSender

__all__ = ["GAP", "StatusText", "StatustextReceiver", "StatustextSender", "chunks_of"]
