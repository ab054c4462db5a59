"""Studies: many runs that answer one question, a module each."""
