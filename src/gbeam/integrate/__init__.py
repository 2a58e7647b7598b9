"""Structural time integration. Knows nothing of beams.

A scheme is data: which combinations of the last state its stages start from, and what their accelerations add. Linear
equations become one affine map a step, found for many steps at once. Nonlinear ones are solved in windows of many
steps by Newton's method. Neither compiles anything. Batches are compiled, and derivatives of runs that JAX traces.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
