"""The systems that come with mbsym: ``mbsym examples`` lists and copies them."""
