"""Results of an imitation: peaks and stretches accounted for, differences, damage, verdict, placement."""
