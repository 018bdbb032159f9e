"""Labels in time, and the table that links them to operating conditions."""
