"""A URDF for a case: one link (`link`), or all links and joints as tables (`tree`), and all other parts (`features`)."""
