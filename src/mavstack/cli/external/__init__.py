"""The command `mav external`."""
