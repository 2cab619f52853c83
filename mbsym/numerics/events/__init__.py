"""What happens in a run: zeros of conditions on dense output, surfaces of switches, changes of method."""
