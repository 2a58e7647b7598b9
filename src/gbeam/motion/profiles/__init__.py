"""What a quantity does over time: straight pieces, pulses, smooth steps, and their smoothing."""
