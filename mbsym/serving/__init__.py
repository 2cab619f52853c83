"""``mbsym edit``: one description served to a page on this machine, and nobody else.

``guard`` lets nothing in that is not the page's, ``storage`` keeps the one file and its journal, ``looking`` says what
a text means, ``jobs`` derives in processes of their own, ``application`` are the routes, ``server`` runs it.
"""
