"""Actions of a vehicle, each requested as its firmware wants it and monitored until it is complete."""
