"""Reports: results become text, one ``Target`` per kind of file.  Nothing is computed here."""
