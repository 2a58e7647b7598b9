"""How far a result is from the truth: what the complete equations with more shapes say at the solution."""
