"""All steady motions at numbers: conditions, exact solution, search in boxes, listing, verdicts; Staude's cone."""
