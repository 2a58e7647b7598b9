"""The machine itself: its axes' kinematics, its limits, examples of machines."""
