"""The three-axis centrifuge: kinematics, limits, example machines, targets, inverses, spin-up."""
