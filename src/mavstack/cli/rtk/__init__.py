"""The command `mav rtk`."""
