"""What is written and said of runs: tables, JSON, plans, certificates, events."""
