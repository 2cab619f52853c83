"""``mbsym batch``: folders of descriptions, what is up to date, the table that is shown meanwhile."""
