"""One file per question: response over time, equilibrium, comparison of two responses, a whole case."""

from gbeam.analysis.case_study import structure_of, study
from gbeam.analysis.comparison import compare
from gbeam.analysis.response import respond
from gbeam.analysis.static import equilibrium

__all__ = ["compare", "equilibrium", "respond", "structure_of", "study"]
