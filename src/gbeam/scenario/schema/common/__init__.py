"""What the scenario's tables are made of: tables, quantities, numbers of a motion."""
