"""The source of members.

`sobol` has the points, `draws` the distributions, `tables` what users give, and `members` makes scenes and cases of all of it.
"""
