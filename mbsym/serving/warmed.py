"""Imported by the process that others are forked from: with this everything is loaded, and was used once.

Nothing else imports it.
"""

import gc

from mbsym.serving.worker import warm

warm()
gc.collect()
gc.freeze()  # what is there stays shared
