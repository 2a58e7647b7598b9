"""What a machine makes of a flight: peaks and stretches accounted for, differences, damage, verdict, placement."""
