"""Parts shared by several commands: options, the connection to a vehicle, progress, tables, values."""
