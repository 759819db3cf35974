"""The command `mav`: one package per command, the parts that they share in `common`."""
