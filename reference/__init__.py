"""The mechanics that everything else is held against: R. F. Gans, *Engineering Dynamics*, Springer 2013, chapter 2."""
