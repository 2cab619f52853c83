"""One file, one problem: a pure function from typed inputs to one frozen result."""
