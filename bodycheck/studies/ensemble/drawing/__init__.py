"""The source of members.

`draws` maps points of sequences to distributions, `tables` reads what users give, and `members` makes scenes and cases of both.
"""
