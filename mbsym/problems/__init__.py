"""One file, one problem: a pure function from typed inputs to one frozen result."""

#: The numbers under which ``mbsym.analysis`` lists them; here for those who only have to know what may be asked for.
NUMBERS = range(1, 9)
