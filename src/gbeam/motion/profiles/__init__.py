"""Profiles of quantities over time: straight pieces, pulses, smooth steps, and their smoothing."""
