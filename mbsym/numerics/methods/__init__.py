"""Integration methods: one file a family, one table of names."""
