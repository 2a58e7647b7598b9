"""What many runs of one scenario say together: which value matters, what a measurement means, which value is best."""
