"""A centrifuge's axes: limits, tracking, plan, and where to put the specimen."""
