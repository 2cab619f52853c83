"""A system as a picture in three dimensions, its motion, modes and equilibria: values for pages, no pixels.

>>> import mbsym
>>> from mbsym.picture import picture
>>> found = picture(mbsym.load("systems/double-pendulum.yaml").system)
>>> [body.name for body in found.bodies], found.view.plane
(['first rod', 'second rod'], True)
"""

from mbsym.picture.build import picture, picture_at
from mbsym.picture.encode import as_json
from mbsym.picture.values import Picture
