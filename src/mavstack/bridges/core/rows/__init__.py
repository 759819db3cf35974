"""The mapping table: the rows by subject, each beside its converter."""
