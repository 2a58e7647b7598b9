"""Names that analyses still import; nothing is an instance of them any more."""


class HubRate:
    """Former hub."""


class HubTorque:
    """Former hub."""
