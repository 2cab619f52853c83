"""A simulation from a description to a result.

==============  ====================================================================================
``request``     what is asked for, and what of it cannot be done
``choosing``    what that leaves open: method and samples (``sampling``)
``run``         integrates, judges what is kept (``kept``), estimates the error
``watching``    events, conditions that end it, sections: as asked for and as found
``result``      what was found
``accurate``    plans a run for an accuracy, and runs it
==============  ====================================================================================
"""

from mbsym.simulation.request import TOLERANCE, Request, read_values
from mbsym.simulation.result import Chosen, FollowedIntegral, Simulation
from mbsym.simulation.run import CERTIFYING, COMPILING, ESTIMATING, INTEGRATING, SOON_DONE, integrated_system, simulate
from mbsym.simulation.sampling import SAMPLES, sample_times
from mbsym.simulation.watching import NoEvent, Watch, read_watch
