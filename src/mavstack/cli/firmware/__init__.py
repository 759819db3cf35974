"""`mav firmware`: show firmware files and boards, and flash them."""
