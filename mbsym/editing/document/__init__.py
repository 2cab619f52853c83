"""One text, three views: what form and graph show of a description, and the edits of its text that operations mean."""

from mbsym.editing.document.changing import changes
from mbsym.editing.document.view import look
