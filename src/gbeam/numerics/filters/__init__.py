"""Digital filters and oscillators on evenly sampled histories, without scipy.signal."""
