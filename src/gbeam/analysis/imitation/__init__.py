"""A centrifuge that imitates a flight: its plan, the comparison of two responses, where to put the specimen."""
