"""Constants of nature."""

STANDARD_GRAVITY = 9.80665  # m/s²
