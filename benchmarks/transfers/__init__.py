"""Transfers over good and bad links: ours and the peers' clients against the same vehicles."""
