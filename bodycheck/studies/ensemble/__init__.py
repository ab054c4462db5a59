"""The study of ensembles: many members are drawn from one case, and every method is run with each of them."""
