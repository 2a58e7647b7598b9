"""The centrifuge alone: what its axes do, what that uses of its limits, its plan and commands."""
