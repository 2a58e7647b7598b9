"""Small numerics that several rooms share; nothing here knows a beam, a base or a result."""
