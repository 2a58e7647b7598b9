"""What all figures share: style and layout, lines and envelopes, units that suit a size, shading, limits, files."""
