"""Every kind of result by its name."""

from __future__ import annotations

from gbeam.results.cases import Sensitivity, Sweep
from gbeam.results.equilibrium import Critical, CriticalMap, Deflection
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.placement import Placement
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.modal import Campbell, Modes
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.searches import Fit, Optimum, ShapedCommand
from gbeam.results.state_space import StateSpace
from gbeam.results.study import ModelStudy, Study

KINDS: dict[str, type[Result]] = {
    kind.__name__: kind
    for kind in (
        Study,
        Response,
        Comparison,
        ModelStudy,
        Deflection,
        Modes,
        Campbell,
        Critical,
        CriticalMap,
        StateSpace,
        MachinePlan,
        Placement,
        Sweep,
        Sensitivity,
        Fit,
        Optimum,
        ShapedCommand,
    )
}
