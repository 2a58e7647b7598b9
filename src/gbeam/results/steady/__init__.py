"""What questions about one steady state return: equilibrium, loss of it, small vibrations about it, state space."""
