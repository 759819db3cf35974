"""Transfers over good and bad links: the clients of Mavstack and of the peers with the same vehicles."""
