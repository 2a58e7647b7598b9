"""What the sections of a beam carry, and its static answer to acceleration fields."""
