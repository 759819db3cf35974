"""Own bodies: motion from the outputs of real firmware, as a rigid body.

The bodies of `mavstack.sim.motion` fly by demands (a place, a speed); these ones fly by motors and surfaces.
"""
