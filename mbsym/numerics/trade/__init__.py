"""Accuracy against cost: references with errors of their own, and trials that are judged by them."""
