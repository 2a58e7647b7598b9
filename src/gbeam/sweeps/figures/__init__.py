"""What is measured of a case: figures of every verb, histories, and statistics over the cases."""
