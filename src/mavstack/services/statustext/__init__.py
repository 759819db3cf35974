"""Status texts (STATUSTEXT), long ones in chunks."""

from mavstack.services.statustext.chunks import chunks_of
from mavstack.services.statustext.receiver import EVENT_MARK, GAP, StatusText, StatustextReceiver
from mavstack.services.statustext.sender import StatustextSender

__all__ = ["EVENT_MARK", "GAP", "StatusText", "StatustextReceiver", "StatustextSender", "chunks_of"]
