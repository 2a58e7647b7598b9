"""Results of one instant: equilibrium and its loss, small vibrations, the state-space model."""
