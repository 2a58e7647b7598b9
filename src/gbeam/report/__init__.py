"""Every result in words for people; one module per kind of result, whose ``text`` the command line prints.

study/ has responses, their comparisons and the study of models; machine/ the axes of a centrifuge and the placement;
steady/ results at one instant; studies/ sweeps and searches. `facts` is the JSON, with the sentences of these words.
"""

from gbeam.report.words import as_json

__all__ = ["as_json"]
