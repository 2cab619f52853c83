"""Imported by the process that others are forked from: with this everything is loaded, and was used once.

Nothing else imports it.
"""

import gc
import signal

from mbsym.serving.worker import warm

signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C in a terminal is for the server, which ends this process
warm()
gc.collect()
gc.freeze()  # what is there stays shared
