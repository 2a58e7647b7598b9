"""Motions of the base: profiles, records, flight, hub and centrifuge. Knows nothing of beams.

Every motion is a :class:`Motion`: it has a `kind`, ``base(t)`` (a :class:`Base`), ``corners(step)`` and ``over(start,
end)``; a hub that is `free` to turn has a torque in place of a motion.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
