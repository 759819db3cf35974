"""The command `mav ftp`."""
