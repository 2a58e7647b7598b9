"""Old place, until its users have moved."""

from gbeam.results.state_space import Signal as Signal
from gbeam.results.state_space import StateSpace as StateSpace
from gbeam.results.state_space import import_control as import_control
