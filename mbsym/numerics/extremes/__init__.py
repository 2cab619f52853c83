"""How digits are lost at the extremes of states; where the mass matrix, or constraints, are singular."""
