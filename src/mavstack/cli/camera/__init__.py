"""The command `mav camera`."""
