"""The JSON files that mbsym writes, as types: a module a kind of file.  Their schemas are made from the types."""
