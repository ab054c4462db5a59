"""Print the attitude error (rad) of Simbody's CPodes, by OpenSim, after 10 s of a brick spun about its intermediate axis."""
