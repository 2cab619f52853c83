"""A folder of descriptions: one process each with budgets of its own, outcomes as values, results that are kept.

``outcome`` has the values (Row, Summary), ``task`` what is to be done with one description, ``work`` does it in the
process that calls, ``isolation`` in a process of its own, ``executor`` several of them at once.  Nothing here writes a
file; what has to be quick when everything is up to date (``outcome``, ``digests``, ``rows``) imports no algebra.
"""
