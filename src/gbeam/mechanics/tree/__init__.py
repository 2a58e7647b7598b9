"""A tree of bodies joined by joints: motion goes out from the ground, wrenches come back."""
