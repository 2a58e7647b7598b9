"""Every result in words for people and as one JSON object for programs; one module per kind of result.

study/ has responses, their comparisons and the study of models; machine/ the axes of a centrifuge and the placement;
steady/ results at one instant: equilibrium, modes, Campbell, critical values, state space. Each module has
``to_json`` and ``text``, of which the command line prints one.
"""

from gbeam.report.words import as_json

__all__ = ["as_json"]
