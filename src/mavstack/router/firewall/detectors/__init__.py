"""The detectors of the firewall, one module each; see `mavstack.router.firewall.detector`."""
